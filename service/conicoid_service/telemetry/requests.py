"""The layer around the whole application that sees every request begin and end."""

import logging
import re
import time
import uuid
from typing import Any, Final

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from conicoid_service.telemetry.context import Notes, added_up, request_id, take_notes
from conicoid_service.telemetry.metrics import Ended, Metrics
from conicoid_service.telemetry.traces import Traces

HEADER: Final = "X-Request-ID"
OTHER: Final = "other"  # a label's value for all that clients make up

_ID: Final = re.compile(r"[A-Za-z0-9._-]{1,128}")
_METHODS: Final = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
_PROBES: Final = frozenset({"/livez", "/readyz", "/metrics"})  # asked every few seconds: logged where they fail
_CLIENT_GONE: Final = 499  # as others name a request that ended without an answer

logger = logging.getLogger(__name__)


class Requests:
    """ASGI middleware: gives each request an id, counts it, logs it in one line."""

    def __init__(self, app: ASGIApp, metrics: Metrics, traces: Traces | None = None) -> None:
        self._app, self._metrics, self._traces = app, metrics, traces

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        watch = _Watch(scope, receive, send)
        with self._metrics.in_progress.track_inprogress():
            try:
                await self._app(scope, watch.receive, watch.send)
            finally:
                ended = watch.ended()
                self._metrics.ended(ended, watch.notes.code, watch.notes.image)
                _log(scope, ended, watch.notes)
                if self._traces:
                    _trace(self._traces, scope, ended, watch.notes)


class _Watch:
    """One request on its way: counts what passes in both directions."""

    def __init__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self._scope, self._receive, self._send = scope, receive, send
        self._started = time.perf_counter()
        self._status, self._bytes_in, self._bytes_out = _CLIENT_GONE, 0, 0
        given = Headers(scope=scope).get(HEADER, "")
        self._id = given if _ID.fullmatch(given) else uuid.uuid4().hex
        request_id.set(self._id)
        self.notes = take_notes()

    async def receive(self) -> Message:
        """The next part of the request."""
        message = await self._receive()
        self._bytes_in += len(message.get("body", b""))
        return message

    async def send(self, message: Message) -> None:
        """The next part of the answer."""
        if message["type"] == "http.response.start":
            self._status = message["status"]
            MutableHeaders(scope=message)[HEADER] = self._id
        await self._send(message)
        self._bytes_out += len(message.get("body", b""))

    def ended(self) -> Ended:
        """What became of it."""
        method = self._scope["method"]
        return Ended(
            route_of(self._scope),
            method if method in _METHODS else OTHER,
            self._status,
            time.perf_counter() - self._started,
            self._bytes_in,
            self._bytes_out,
        )


def route_of(scope: Scope) -> str:
    """The template of the request's path, `OTHER` where no route has it."""
    path = getattr(scope.get("route"), "path", None)
    if path is None and scope.get("endpoint") and not scope.get("path_params"):
        path = scope["path"]  # of a route without parameters that is not one of FastAPI's own kind
    return path if isinstance(path, str) else OTHER


def _log(scope: Scope, ended: Ended, notes: Notes) -> None:
    fields: dict[str, Any] = {
        "method": ended.method,
        "route": ended.route,
        "status": ended.status,
        "ms": round(ended.seconds * 1e3, 3),
        "bytes_in": ended.bytes_in,
        "bytes_out": ended.bytes_out,
    }
    owner = scope.get("state", {}).get("owner", "")
    fields |= {name: text for name, text in (("owner", owner), ("code", notes.code), ("image", notes.image)) if text}
    if notes.steps:
        stages = added_up(step.stages for step in notes.steps)
        fields["stages_ms"] = {stage: round(duration_ms, 3) for stage, duration_ms in stages.items()}
    quiet = ended.route in _PROBES and ended.status < 400
    level = logging.DEBUG if quiet else logging.WARNING if ended.status >= 500 else logging.INFO
    logger.log(level, "request", extra=fields)


def _trace(traces: Traces, scope: Scope, ended: Ended, notes: Notes) -> None:
    attributes = {
        "http.request.method": ended.method,
        "http.route": ended.route,
        "http.response.status_code": ended.status,
        "conicoid.request_id": request_id.get(),
    }
    headers = Headers(scope=scope)
    traces.record(f"{ended.method} {ended.route}", headers, attributes, ended.seconds, time.time_ns(), notes.steps)
