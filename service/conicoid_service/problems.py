"""Errors as RFC 9457 problem documents, on every route."""

from collections.abc import Mapping
from typing import Any, Final

import orjson
from fastapi.exceptions import RequestValidationError
from starlette.responses import Response

from conicoid.errors import ConicoidError, LimitError, SceneError
from conicoid_service.errors import DEFECT, ReportedError, ServiceError
from conicoid_service.telemetry import context

MEDIA_TYPE: Final = "application/problem+json"

# code: (HTTP status, title). A scene document's own codes, `scene-...`, are SCENE unless they are here.
STATUS: Final[dict[str, tuple[int, str]]] = {
    "bad-request": (400, "Bad request"),
    "scene-json": (400, "Body is not JSON"),
    "scene-npz": (400, "Arrays are not an .npz file"),
    "multipart": (400, "Body is not as its type says"),
    "content-encoding-data": (400, "Body is not as its encoding says"),
    "unauthorized": (401, "No API key"),
    "not-found": (404, "Not found"),
    "unknown-scene": (404, "Scene not kept"),
    "unknown-job": (404, "No such job"),
    "frame-not-ready": (404, "Frame not there"),
    "frame-failed": (404, "Frame failed"),
    "method-not-allowed": (405, "Method not allowed"),
    "body-timeout": (408, "Body too slow"),
    "head-timeout": (408, "Request too slow"),
    "limit": (413, "Too much work"),
    "memory": (413, "Too much memory"),
    "media-type": (415, "Unsupported media type"),
    "content-encoding": (415, "Unsupported content encoding"),
    "camera-range": (422, "Camera beyond binary64"),
    "parameter": (422, "Path or query unusable"),
    "idempotency-key": (422, "Idempotency key unusable"),
    "job-limit": (429, "Too many frames"),
    "queue-full": (429, "Too many requests"),
    "quadrics-file": (500, "Stored quadrics damaged"),
    "bands": (500, "Bands make no frame"),
    "quota": (429, "Too many requests at once"),
    "head-limit": (431, "Request head too long"),
    "error": (500, "Internal error"),
    "internal": (500, "Internal error"),
    "render-crashed": (500, "Render process crashed"),
    "render-unavailable": (503, "Render process unavailable"),
    "device-missing": (503, "No OpenCL device"),
    "kernel-build": (503, "Kernels do not build"),
    "not-ready": (503, "Not ready"),
    "stopping": (503, "Shutting down"),
    "no-jobs": (503, "No jobs here"),
    "connection-limit": (503, "Too many connections"),
    "render-timeout": (504, "Deadline passed"),
    "storage": (507, "Disk full or not writable"),
}
SCENE: Final = (422, "Invalid scene document")

_CODE_OF_STATUS: Final = {404: "not-found", 405: "method-not-allowed"}


def problem(error: ConicoidError, status: int | None = None, **more: Any) -> Response:
    """The response that tells a client about `error`; `status` in place of its own, `more` members than usual."""
    headers: dict[str, str] = {}
    members: dict[str, Any] = {"detail": str(error)}
    if isinstance(error, SceneError | ReportedError) and error.problems:
        members["detail"] = _summary(len(error.problems), str(error.problems[0]))
        members["errors"] = [
            {"pointer": one.pointer, "message": one.message, "code": one.code} for one in error.problems
        ]
    if isinstance(error, LimitError | ReportedError) and error.limit is not None:
        members |= {"limit": error.limit, "asked": error.asked}
    if isinstance(error, ServiceError):
        headers = dict(error.headers)
        if error.retry_after_s is not None:
            headers["Retry-After"] = str(error.retry_after_s)
    return _response(error.code, members | more, headers, status)


def http_problem(status: int, detail: str, headers: Mapping[str, str] | None = None) -> Response:
    """The response for an error of HTTP itself: no such route, a method that the route does not have."""
    return _response(_CODE_OF_STATUS.get(status, "bad-request"), {"detail": detail}, headers, status)


def parameter_problem(error: RequestValidationError) -> Response:
    """The response for a path or query that is not as it should be; what was given is not repeated."""
    errors = [
        {"pointer": ".".join(map(str, one["loc"])), "message": str(one["msg"]), "code": "parameter"}
        for one in error.errors()
    ]
    detail = _summary(len(errors), f"{errors[0]['pointer']}: {errors[0]['message']}")
    return _response("parameter", {"detail": detail, "errors": errors}, None)


def internal_problem() -> Response:
    """The response for a defect; the log has the details, the client gets none."""
    return _response("internal", {"detail": DEFECT}, None)


def _summary(count: int, first: str) -> str:
    return first if count == 1 else f"{first} (and {count - 1} more)"


def _response(
    code: str, members: dict[str, Any], headers: Mapping[str, str] | None, status: int | None = None
) -> Response:
    own_status, title = STATUS.get(code, SCENE)
    context.notes().code = code
    body = {
        "type": f"urn:conicoid:problem:{code}",
        "title": title,
        "status": status or own_status,
        "code": code,
        "errors": [],
        **({"request_id": asked} if (asked := context.request_id.get()) else {}),
        **members,
    }
    return Response(orjson.dumps(body), status or own_status, headers, MEDIA_TYPE)
