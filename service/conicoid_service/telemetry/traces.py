"""Traces for an OpenTelemetry collector: a span for each request, with its stages below it.

Spans are made when the request has ended, from its notes: nothing has to be carried along. Without the usual
`OTEL_...` variables nothing of the SDK is loaded.
"""

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from conicoid_service.errors import SettingsError
from conicoid_service.telemetry.context import Step

if TYPE_CHECKING:
    from opentelemetry.sdk.trace import TracerProvider

_ENDPOINTS: Final = ("OTEL_EXPORTER_OTLP_ENDPOINT", "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT")


class Traces:
    """Spans of requests, on their way to a collector."""

    def __init__(self, provider: "TracerProvider") -> None:
        from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator

        self._provider = provider
        self._tracer = provider.get_tracer("conicoid")
        self._propagator = TraceContextTextMapPropagator()

    def record(
        self, name: str, headers: Mapping[str, str], attributes: Mapping[str, Any], seconds: float, ended_ns: int,
        steps: Sequence[Step],
    ) -> None:  # fmt: skip
        """A request that ended at `ended_ns` after `seconds`; `headers` may name the span that it belongs to."""
        from opentelemetry.trace import SpanKind, set_span_in_context

        begun_ns = ended_ns - round(seconds * 1e9)
        parent = self._propagator.extract(dict(headers))
        span = self._tracer.start_span(name, parent, SpanKind.SERVER, attributes, start_time=begun_ns)
        below = set_span_in_context(span)
        for step in steps:
            at = step.ended_ns - round(sum(step.stages.values()) * 1e6)
            for stage, duration_ms in step.stages.items():
                until = at + round(duration_ms * 1e6)
                part = self._tracer.start_span(
                    stage, below, attributes={"conicoid.process": step.process}, start_time=at
                )
                part.end(until)
                at = until
        span.end(ended_ns)

    def close(self) -> None:
        """Send what is left; may take as long as the exporter's timeout."""
        self._provider.shutdown()


def traces_from(environment: Mapping[str, str] = os.environ) -> Traces | None:
    """What the environment asks for; None if it asks for no traces.

    Raises:
        SettingsError: it asks for what is not installed, or not supported.
    """
    exporter = environment.get("OTEL_TRACES_EXPORTER") or ("otlp" if any(map(environment.get, _ENDPOINTS)) else "none")
    if exporter == "none" or environment.get("OTEL_SDK_DISABLED", "").lower() == "true":
        return None
    if exporter != "otlp":
        raise SettingsError(f"OTEL_TRACES_EXPORTER: {exporter[:80]!r} is not supported; set otlp or none")
    try:
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
        from opentelemetry.sdk.resources import Resource
        from opentelemetry.sdk.trace import TracerProvider
        from opentelemetry.sdk.trace.export import BatchSpanProcessor
    except ImportError:
        raise SettingsError(
            "OTEL_...: traces are asked for, but OpenTelemetry is not installed; pip install 'conicoid[telemetry]', or "
            "set OTEL_TRACES_EXPORTER=none"
        ) from None
    name = environment.get("OTEL_SERVICE_NAME") or "conicoid"
    provider = TracerProvider(resource=Resource.create({"service.name": name}), shutdown_on_exit=False)
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    return Traces(provider)
