"""What a hostile request is, and HTTP around its hostile part."""

from typing import NamedTuple

CLOSE = b"Connection: close\r\n"
JSON = b"Content-Type: application/json\r\n"
EVIL = b"x-evil"  # the header that injections try to add


class Hostile(NamedTuple):
    """A request.

    Attributes:
        name: what is hostile about it, unique among all.
        sent: all bytes that the client sends.
        statuses: what the answer may be; none where the server may close without one.
    """

    name: str
    sent: bytes
    statuses: tuple[int, ...]


def request(
    method: bytes = b"GET", path: bytes = b"/livez", headers: bytes = b"", body: bytes | None = None, host: bytes = b"x"
) -> bytes:
    """A request whose parts may be anything; it asks the server to close."""
    length = b"" if body is None else b"Content-Length: %d\r\n" % len(body)
    return b"%s %s HTTP/1.1\r\nHost: %s\r\n%s%s%s\r\n%s" % (method, path, host, CLOSE, headers, length, body or b"")


def render(body: bytes, headers: bytes = JSON) -> bytes:
    """A render of a body."""
    return request(b"POST", b"/v1/render", headers, body)


def multipart(body: bytes, boundary: bytes = b"b") -> bytes:
    """A render of a multipart body."""
    return render(body, b"Content-Type: multipart/form-data; boundary=%s\r\n" % boundary)


def part(name: bytes, content: bytes) -> bytes:
    """One part between the boundaries `b`."""
    return b'--b\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n' % (name, content)
