"""Request bodies: checked for their type, then streamed into a blob that never grows past the limit."""

import hashlib
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING

from conicoid.errors import LimitError
from conicoid_service.blob import Blob
from conicoid_service.errors import ContentEncodingError, MediaTypeError
from conicoid_service.multipart import boundary_of

if TYPE_CHECKING:
    from starlette.requests import Request


@dataclass(frozen=True)
class Body:
    """A request's body.

    Attributes:
        blob: its bytes; whoever is last to use them closes it.
        boundary: between its parts, if it is `multipart/form-data`; None for JSON.
        digest: SHA-256 in hexadecimal of boundary and bytes: bodies with the same one are the same.
    """

    blob: Blob
    boundary: str | None
    digest: str


async def receive(request: "Request", limit: int) -> Body:
    """The body of a request with a scene document: `application/json`, or `multipart/form-data`.

    Raises:
        MediaTypeError, ContentEncodingError: it is neither of them, not in UTF-8, or compressed.
        LimitError: it is longer than `limit` bytes; a declared length is refused before anything is read.
        ClientDisconnect: the client went away.
    """
    boundary = _check_type(request)
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and int(declared) > limit:
        raise _too_long(limit, int(declared))
    with ExitStack() as on_error:
        body = on_error.enter_context(Blob())
        received, digest = 0, hashlib.sha256(f"{boundary}\n".encode())
        async for chunk in request.stream():
            received += len(chunk)
            if received > limit:
                raise _too_long(limit, received)
            body.append(chunk)
            digest.update(chunk)
        on_error.pop_all()
    return Body(body, boundary, digest.hexdigest())


def _check_type(request: "Request") -> str | None:
    """The boundary of a multipart body, None for JSON."""
    given = request.headers.get("content-type", "of no given type")
    boundary = boundary_of(given)
    media_type, _, parameters = given.partition(";")
    charset = parameters.strip().lower().removeprefix("charset=").strip('"')
    if boundary is None and (media_type.strip().lower() != "application/json" or charset not in ("", "utf-8")):
        raise MediaTypeError(
            f"the body is {given!r}, a scene document is JSON in UTF-8; send it with `Content-Type: application/json`, "
            "or as the part scene of multipart/form-data"
        )
    encoding = request.headers.get("content-encoding", "identity").strip().lower()
    if encoding != "identity":
        raise ContentEncodingError(f"the body is encoded as {encoding!r}, only plain bodies are read; send it as it is")
    return boundary


def _too_long(limit: int, asked: int) -> LimitError:
    return LimitError("bytes of body", limit, asked)
