"""The Prometheus metrics of one application; `docs/operations.md` lists them.

Every label has few values, whatever clients send: routes are templates, methods and codes those that exist.
"""

import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, Info, ProcessCollector, generate_latest
from prometheus_client.core import Metric
from prometheus_client.registry import Collector

from conicoid import __version__
from conicoid_service.telemetry.context import Step
from conicoid_service.telemetry.watched import Readers

CONTENT_TYPE: Final = "text/plain; version=0.0.4; charset=utf-8"

# From a request that is answered from memory to one that takes the default deadline.
_REQUEST_S: Final = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60)
_STAGE_S: Final = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60)


@dataclass(frozen=True)
class Ended:
    """A request that has been answered, as the metrics see it."""

    route: str
    method: str
    status: int
    seconds: float
    bytes_in: int
    bytes_out: int


class Metrics:
    """Metrics in a registry of their own."""

    def __init__(self) -> None:
        registry = self.registry = CollectorRegistry(auto_describe=True)
        ProcessCollector(registry=registry)
        info = Info("conicoid_build", "Version of the service and of Python", registry=registry)
        info.info({"version": __version__, "python": platform.python_version()})
        self.readers = Readers()
        self.in_progress = Gauge("conicoid_requests_in_progress", "Requests under way", registry=registry)
        self._requests = Counter(
            "conicoid_requests", "Requests answered", ("route", "method", "status"), registry=registry
        )
        self._request_s = Histogram(
            "conicoid_request_seconds",
            "From the request's head to the last byte of the answer",
            ("route",),
            buckets=_REQUEST_S,
            registry=registry,
        )
        self._stage_s = Histogram(
            "conicoid_stage_seconds",
            "Stages of the work on requests and frames",
            ("process", "stage"),
            buckets=_STAGE_S,
            registry=registry,
        )
        self._received = Counter("conicoid_received_bytes", "Bytes of the bodies of requests", registry=registry)
        self._sent = Counter("conicoid_sent_bytes", "Bytes of the bodies of answers", registry=registry)
        self._refusals = Counter("conicoid_refusals", "Problem documents sent", ("code",), registry=registry)
        self._images = Counter(
            "conicoid_images", "Images that renders were answered with, by where they came from", ("source",),
            registry=registry,
        )  # fmt: skip
        self._pixels = Counter("conicoid_pixels", "Pixels rendered, a ray each", registry=registry)
        self._quadrics = Counter("conicoid_quadrics", "Quadrics of the scenes rendered", registry=registry)
        self._escalated = Counter(
            "conicoid_escalated_pixels", "Pixels that binary64 could not certify", ("how",), registry=registry
        )
        for how in ("refined", "settled"):
            self._escalated.labels(how)
        for source in ("304", "memory", "store", "shared", "rendered"):
            self._images.labels(source)

    def answered(self, step: Step, message: Mapping[str, Any]) -> None:
        """A child process has answered with `message`."""
        for stage, duration_ms in step.stages.items():
            self._stage_s.labels(step.process, stage).observe(duration_ms / 1e3)
        if "refined" in message:
            self._pixels.inc(message["pixels"])
            self._quadrics.inc(message["quadrics"])
            for how in ("refined", "settled"):
                self._escalated.labels(how).inc(message[how])

    def ended(self, request: Ended, code: str, image: str) -> None:
        """A request has been answered; `code` and `image` as in `context.Notes`."""
        self._requests.labels(request.route, request.method, request.status).inc()
        self._request_s.labels(request.route).observe(request.seconds)
        self._received.inc(request.bytes_in)
        self._sent.inc(request.bytes_out)
        if code:
            self._refusals.labels(code).inc()
        if image:
            self._images.labels(image).inc()

    async def text(self) -> bytes:
        """All metrics in Prometheus' text format."""
        return generate_latest(_Scrape([*self.registry.collect(), *await self.readers.read()]))


class _Scrape(Collector):
    """Metrics that have been read already."""

    def __init__(self, found: Iterable[Metric]) -> None:
        self._found = found

    def collect(self) -> Iterable[Metric]:
        """All of them."""
        return self._found
