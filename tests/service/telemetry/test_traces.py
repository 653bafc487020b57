"""A request is one span under its caller's, its stages lie below it in order, and nothing is loaded unasked."""

import subprocess
import sys
import time

import pytest
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import SimpleSpanProcessor
from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter

from conicoid_service.errors import SettingsError
from conicoid_service.telemetry.context import Step
from conicoid_service.telemetry.traces import Traces, traces_from

PARENT = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01"


def test_stages_lie_below_the_request_and_the_request_below_its_caller() -> None:
    exporter = InMemorySpanExporter()
    provider = TracerProvider(shutdown_on_exit=False)
    provider.add_span_processor(SimpleSpanProcessor(exporter))
    now = time.time_ns()
    steps = [Step("document", {"queue": 1.0, "parse": 2.0}, now - 9_000_000), Step("render", {"cast": 4.0}, now)]
    Traces(provider).record("POST /v1/render", {"traceparent": PARENT}, {"status": 200}, 0.02, now, steps)
    *stages, request = exporter.get_finished_spans()
    assert request.parent is not None
    assert f"{request.parent.trace_id:032x}-{request.parent.span_id:016x}" == PARENT[3:-3]
    assert request.end_time == now
    assert request.start_time == now - 20_000_000
    assert [one.name for one in stages] == ["queue", "parse", "cast"]
    assert {one.parent.span_id for one in stages if one.parent} == {request.context.span_id}
    assert [(one.end_time or 0) - (one.start_time or 0) for one in stages] == [1_000_000, 2_000_000, 4_000_000]
    assert stages[0].end_time == stages[1].start_time


@pytest.mark.parametrize("environment", [{}, {"OTEL_TRACES_EXPORTER": "none", "OTEL_EXPORTER_OTLP_ENDPOINT": "x"}])
def test_who_asks_for_no_traces_gets_none(environment: dict[str, str]) -> None:
    assert traces_from(environment) is None


def test_an_unknown_exporter_is_refused() -> None:
    with pytest.raises(SettingsError, match="OTEL_TRACES_EXPORTER: 'zipkin' is not supported"):
        traces_from({"OTEL_TRACES_EXPORTER": "zipkin"})


def test_traces_without_the_library_are_refused_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "opentelemetry.sdk.trace", None)
    with pytest.raises(SettingsError, match=r"pip install 'conicoid\[telemetry\]'"):
        traces_from({"OTEL_EXPORTER_OTLP_ENDPOINT": "http://127.0.0.1:4318"})


def test_the_application_loads_nothing_of_it_unasked() -> None:
    load = "import conicoid_service.app, sys; conicoid_service.app.create_app(keeps_jobs=False)"
    load += "; print('opentelemetry.sdk' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", load], check=True, capture_output=True).stdout == b"False\n"
