"""Request bodies: checked for their type, then streamed into a blob that never grows past the limit."""

from contextlib import ExitStack

from fastapi import Request

from conicoid.errors import LimitError
from conicoid_service.blob import Blob
from conicoid_service.errors import ContentEncodingError, MediaTypeError


async def receive_json(request: Request, limit: int) -> Blob:
    """The body of an `application/json` request; the caller closes it.

    Raises:
        MediaTypeError, ContentEncodingError: it is not JSON in UTF-8, or it is compressed.
        LimitError: it is longer than `limit` bytes; a declared length is refused before anything is read.
        ClientDisconnect: the client went away.
    """
    _check_type(request)
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and int(declared) > limit:
        raise _too_long(limit, int(declared))
    with ExitStack() as on_error:
        body = on_error.enter_context(Blob())
        received = 0
        async for chunk in request.stream():
            received += len(chunk)
            if received > limit:
                raise _too_long(limit, received)
            body.append(chunk)
        on_error.pop_all()
    return body


def _check_type(request: Request) -> None:
    media_type, _, parameters = request.headers.get("content-type", "").partition(";")
    charset = parameters.strip().lower().removeprefix("charset=").strip('"')
    if media_type.strip().lower() != "application/json" or charset not in ("", "utf-8"):
        given = request.headers.get("content-type", "of no given type")
        raise MediaTypeError(
            f"the body is {given!r}, a scene document is JSON in UTF-8; send it with `Content-Type: application/json`"
        )
    encoding = request.headers.get("content-encoding", "identity").strip().lower()
    if encoding != "identity":
        raise ContentEncodingError(f"the body is encoded as {encoding!r}, only plain bodies are read; send it as it is")


def _too_long(limit: int, asked: int) -> LimitError:
    return LimitError("bytes of body", limit, asked)
