"""A worker's probes and metrics, in its first process."""

import logging
import threading
from collections.abc import Callable, Iterable
from http import HTTPStatus
from typing import Any, Final
from wsgiref.simple_server import WSGIRequestHandler, WSGIServer, make_server

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, make_wsgi_app

_BUCKETS: Final = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60, 120)

logger = logging.getLogger(__name__)


class Watch:
    """Counts what a worker does; on a port, `/livez`, `/readyz` and `/metrics` tell of it.

    Attributes:
        registry: the metrics.
    """

    def __init__(self, port: int) -> None:
        """Listen on `port` of every address; 0 means nowhere."""
        self.registry = CollectorRegistry()
        self._units = Counter("conicoid_worker_units", "Units that were delivered, by how they went", ["outcome"],
                              registry=self.registry)  # fmt: skip
        self._seconds = Histogram("conicoid_worker_unit_seconds", "From the delivery of a unit to its end",
                                  buckets=_BUCKETS, registry=self.registry)  # fmt: skip
        connected = Gauge("conicoid_worker_connected", "Whether the broker is there", registry=self.registry)
        connected.set_function(lambda: float(self.connected))
        for outcome in ("done", "dropped", "unable", "failed"):
            self._units.labels(outcome)
        self._metrics = make_wsgi_app(self.registry)
        self._consumer: Any = None
        if port:
            server = make_server("", port, self._answer, _Server, _Silent)
            threading.Thread(target=server.serve_forever, name="probes", daemon=True).start()

    def count(self, outcome: str, seconds: float | None = None) -> None:
        """A unit has ended, after so long if that is known."""
        self._units.labels(outcome).inc()
        if seconds is not None:
            self._seconds.observe(seconds)

    def follow(self, sender: Any, **_: Any) -> None:
        """The worker has begun to take units: `sender` is its consumer."""
        self._consumer = sender

    @property
    def connected(self) -> bool:
        """Whether the worker takes units."""
        connection = getattr(self._consumer, "connection", None)
        return connection is not None and bool(connection.connected)

    def _answer(self, environ: dict[str, Any], start_response: Callable[..., Any]) -> Iterable[bytes]:
        path = environ["PATH_INFO"]
        if path == "/metrics":
            answer: Iterable[bytes] = self._metrics(environ, start_response)
            return answer
        if path == "/livez":
            status, text = HTTPStatus.OK, b"alive\n"
        elif path == "/readyz":
            ready = self.connected
            status = HTTPStatus.OK if ready else HTTPStatus.SERVICE_UNAVAILABLE
            text = b"ready\n" if ready else b"the broker is not there\n"
        else:
            status, text = HTTPStatus.NOT_FOUND, b"there are /livez, /readyz and /metrics\n"
        headers = [("Content-Type", "text/plain; charset=utf-8"), ("Content-Length", str(len(text)))]
        start_response(f"{status.value} {status.phrase}", headers)
        return [text]


class _Server(WSGIServer):
    daemon_threads = True


class _Silent(WSGIRequestHandler):
    timeout = 10  # seconds for a request's head

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
        """Nothing: probes come every few seconds."""
