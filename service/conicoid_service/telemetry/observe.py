"""Puts an application under observation: the one seam between the service and its telemetry."""

from fastapi import FastAPI

from conicoid_service.telemetry.metrics import Metrics
from conicoid_service.telemetry.readiness import Readiness
from conicoid_service.telemetry.requests import Requests
from conicoid_service.telemetry.sources import watch
from conicoid_service.telemetry.traces import traces_from


def observe(app: FastAPI) -> None:
    """Count and log what the application does, from now on; to be called after the last of its other layers.

    Its state, which has `settings`, `pipeline`, `gallery` and `jobs`, gets `metrics`, `readiness` and `traces`.

    Raises:
        SettingsError: the environment asks for traces that cannot be had.
    """
    metrics = app.state.metrics = Metrics()
    traces = app.state.traces = traces_from()
    watch(metrics.readers, app.state)
    app.state.pipeline.on_answer = metrics.answered
    app.state.readiness = Readiness(app.state)
    app.add_middleware(Requests, metrics, traces)
