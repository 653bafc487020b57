"""CORS: which web pages' scripts may read answers; by default none."""

from collections.abc import Collection
from typing import Final

from starlette.datastructures import Headers
from starlette.middleware.cors import CORSMiddleware
from starlette.responses import Response
from starlette.types import ASGIApp

from conicoid_service.problems import http_problem

_METHODS: Final = ("GET", "POST", "DELETE")
_ASKED: Final = (
    "Authorization", "Content-Encoding", "Idempotency-Key", "If-None-Match", "Last-Event-ID", "Prefer", "X-Request-ID",
)  # fmt: skip
_TOLD: Final = (
    "Conicoid-Refined", "Conicoid-Settled", "Content-Disposition", "ETag", "Location", "Preference-Applied",
    "Retry-After", "Server-Timing", "WWW-Authenticate", "X-Request-ID",
)  # fmt: skip


class Origins(CORSMiddleware):
    """Starlette's middleware for the API's methods and headers, without cookies; its refusals are problems."""

    def __init__(self, app: ASGIApp, origins: Collection[str]) -> None:
        super().__init__(app, origins, _METHODS, _ASKED, expose_headers=_TOLD)

    def preflight_response(self, request_headers: Headers) -> Response:
        """Whether a script may send the request that it is about to send."""
        response = super().preflight_response(request_headers)
        if response.status_code < 400:
            return response
        headers = {key: value for key, value in response.headers.items() if not key.startswith("content-")}
        return http_problem(
            response.status_code, f"{bytes(response.body).decode()}; see the setting cors_origins", headers
        )
