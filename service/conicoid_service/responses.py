"""Responses that FastAPI does not bring along."""

from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from conicoid_service.blob import Blob
from conicoid_service.pipeline import Timings
from conicoid_service.telemetry.context import added_up

EXR_TYPE = "image/x-exr"


class BlobResponse(Response):
    """A blob sent piece by piece, so that an image never lies in this process' memory as a whole."""

    def __init__(self, blob: Blob, headers: dict[str, str], media_type: str) -> None:
        """Take the blob over; it is closed when it has been sent or the client is gone."""
        super().__init__(None, headers={**headers, "Content-Length": str(len(blob))}, media_type=media_type)
        self._blob = blob

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002  # ASGI
        """Send the response."""
        with self._blob:
            await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
            for chunk in self._blob.chunks():
                await send({"type": "http.response.body", "body": chunk, "more_body": True})
            await send({"type": "http.response.body", "body": b"", "more_body": False})


def server_timing(*parts: Timings) -> str:
    """The `Server-Timing` header: milliseconds per stage, those of the same name in several processes added up."""
    return ", ".join(f"{stage};dur={duration_ms:.3f}" for stage, duration_ms in added_up(parts).items())
