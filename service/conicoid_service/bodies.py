"""Request bodies: checked for their type, then streamed into a blob that never grows past the limit."""

import asyncio
import hashlib
import time
from collections.abc import AsyncIterator
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from conicoid.errors import LimitError
from conicoid_service.access.gzip_stream import GzipStream
from conicoid_service.blob import Blob
from conicoid_service.errors import BodyTimeoutError, ContentEncodingError, MediaTypeError
from conicoid_service.multipart import boundary_of
from conicoid_service.settings import Settings

if TYPE_CHECKING:
    from starlette.requests import Request

_SLOWEST: Final = 1024  # bytes a second, on the average, of a body that takes longer than
_PATIENCE_S: Final = 60


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


async def receive(request: "Request", settings: Settings) -> Body:
    """The body of a request with a scene document: `application/json`, or `multipart/form-data`; inflated.

    Args:
        request: whose body.
        settings: how long it may be, both as it is sent and as it inflates, and how slow.
    Raises:
        MediaTypeError, ContentEncodingError: it is neither of them, not in UTF-8, or compressed in another way.
        CompressedDataError: it is not the gzip that it says it is.
        LimitError: it is too long; a declared length is refused before anything is read.
        BodyTimeoutError: it does not arrive, or hardly.
        ClientDisconnect: the client went away.
    """
    boundary = _check_type(request)
    compressed = _check_encoding(request)
    limit, timeout_s = settings.body_limit, settings.body_timeout_s
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and int(declared) > limit:
        raise _too_long(limit, int(declared))
    with ExitStack() as on_error:
        body = on_error.enter_context(Blob())
        digest = hashlib.sha256(f"{boundary}\n".encode())
        sent = _bounded(_timely(request, timeout_s), limit)
        async for piece in _bounded(_inflated(sent), limit) if compressed else sent:
            body.append(piece)
            digest.update(piece)
        on_error.pop_all()
    return Body(body, boundary, digest.hexdigest())


async def _timely(request: "Request", timeout_s: float) -> AsyncIterator[bytes]:
    """The body's bytes as they arrive, as long as they do."""
    started, received = time.monotonic(), 0
    chunks = aiter(request.stream())
    while True:
        try:
            async with asyncio.timeout(timeout_s):
                chunk = await anext(chunks, None)
        except TimeoutError:
            raise BodyTimeoutError(f"no byte of the body came in {timeout_s:g} s; send it faster") from None
        if chunk is None:
            return
        received += len(chunk)
        elapsed_s = time.monotonic() - started
        if elapsed_s > _PATIENCE_S and received < _SLOWEST * elapsed_s:
            raise BodyTimeoutError(f"{received} bytes of the body came in {elapsed_s:.0f} s; send it faster")
        yield chunk


async def _inflated(sent: AsyncIterator[bytes]) -> AsyncIterator[bytes]:
    """What gzip bytes inflate to; other requests get their turn between two pieces."""
    stream = GzipStream()
    async for chunk in sent:
        for piece in stream.inflate(chunk):
            yield piece
            await asyncio.sleep(0)
    stream.finish()


async def _bounded(pieces: AsyncIterator[bytes], limit: int) -> AsyncIterator[bytes]:
    """The pieces, until they are more than `limit` bytes."""
    received = 0
    async for piece in pieces:
        received += len(piece)
        if received > limit:
            raise _too_long(limit, received)
        yield piece


def _check_type(request: "Request") -> str | None:
    """The boundary of a multipart body, None for JSON."""
    given = request.headers.get("content-type", "of no given type")
    boundary = boundary_of(given)
    media_type, _, parameters = given.partition(";")
    charset = parameters.strip().lower().removeprefix("charset=").strip('"')
    if boundary is None and (media_type.strip().lower() != "application/json" or charset not in ("", "utf-8")):
        raise MediaTypeError(
            f"the body is {given[:200]!r}, a scene document is JSON in UTF-8; send it with "
            "`Content-Type: application/json`, or as the part scene of multipart/form-data"
        )
    return boundary


def _check_encoding(request: "Request") -> bool:
    """Whether the body is compressed."""
    encoding = request.headers.get("content-encoding", "identity").strip().lower()
    if encoding not in ("identity", "gzip", "x-gzip"):
        raise ContentEncodingError(f"the body is encoded as {encoding[:80]!r}; send it as it is, or as gzip")
    return encoding != "identity"


def _too_long(limit: int, asked: int) -> LimitError:
    return LimitError("bytes of body", limit, asked)
