"""`multipart/form-data` (RFC 7578): where the parts of a body stand, without taking them out of their file."""

import io
import os
from collections.abc import Iterator
from email.message import Message
from itertools import islice, pairwise
from typing import Final

from conicoid_service.errors import MultipartError

_CHUNK: Final = 1 << 20
_MOST_HEADERS: Final = 1 << 12  # bytes of one part's headers
_MOST_PARTS: Final = 8
REMEDY: Final = "send a JSON part named scene, and perhaps an .npz part named arrays"


class Part(io.RawIOBase):
    """The bytes start ... stop - 1 of a file as a read-only file of their own; it does not own the descriptor."""

    def __init__(self, descriptor: int, start: int, stop: int) -> None:
        self._descriptor, self._start, self._stop, self._at = descriptor, start, max(start, stop), start

    def readall(self) -> bytes:
        """What is left of the part, at once."""
        content = os.pread(self._descriptor, self._stop - self._at, self._at)
        self._at += len(content)
        return content

    def readable(self) -> bool:
        """True."""
        return True

    def seekable(self) -> bool:
        """True."""
        return True

    def readinto(self, buffer: "memoryview | bytearray") -> int:  # type: ignore[override]  # any buffer
        """Fill the buffer, or what is left of the part."""
        view = memoryview(buffer)[: self._stop - self._at]
        count = os.preadv(self._descriptor, [view], self._at)
        self._at += count
        return count

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset from the part's start, the present place or the part's end; not before its start."""
        origin = {os.SEEK_SET: self._start, os.SEEK_CUR: self._at, os.SEEK_END: self._stop}[whence]
        if origin + offset < self._start:
            raise ValueError("before the start")
        self._at = min(origin + offset, self._stop)
        return self._at - self._start


def boundary_of(content_type: str) -> str | None:
    """The boundary in `multipart/form-data; boundary=...`; None if it is not there, or another type is."""
    header = _header("Content-Type", content_type)
    boundary = header.get_boundary("")
    usable = 0 < len(boundary) <= 70 and boundary.isascii() and boundary.isprintable()
    return boundary if usable and header.get_content_type() == "multipart/form-data" else None


def parts_of(descriptor: int, boundary: str) -> dict[str, Part]:
    """The parts of the body in a file, by name.

    Raises:
        MultipartError: it is not so built, a part has no name, or two have the same.
    """
    delimiter = f"\r\n--{boundary}".encode()
    marks = list(islice(_places(descriptor, delimiter), _MOST_PARTS + 2))
    last = bool(marks) and os.pread(descriptor, 2, marks[-1] + len(delimiter)) == b"--"
    if not last or len(marks) > _MOST_PARTS + 1:
        raise MultipartError(f"the body does not end with its boundary, or has too many parts; {REMEDY}")
    found: dict[str, Part] = {}
    for mark, end in pairwise(marks):
        name, start = _head(descriptor, mark + len(delimiter))
        if name in found:
            raise MultipartError(f"the part {name} is there twice; {REMEDY}")
        found[name] = Part(descriptor, start, end)
    return found


def _places(descriptor: int, delimiter: bytes) -> Iterator[int]:
    """Where a delimiter stands, ascending; the first may lack its line break, which then is before the file."""
    if os.pread(descriptor, len(delimiter) - 2, 0) == delimiter[2:]:
        yield -2
    start, overlap = 0, len(delimiter) - 1
    while len(chunk := os.pread(descriptor, _CHUNK + overlap, start)) > overlap:
        place = chunk.find(delimiter)
        while place >= 0:
            yield start + place
            place = chunk.find(delimiter, place + 1)
        start += _CHUNK


def _head(descriptor: int, start: int) -> tuple[str, int]:
    """The name of the part whose delimiter ends at `start`, and where its content begins."""
    text = os.pread(descriptor, _MOST_HEADERS, start)
    head, blank, _ = text.partition(b"\r\n\r\n")
    rest, *lines = head.decode("latin-1").split("\r\n")
    for line in lines if blank and not rest.strip(" \t") else ():
        key, _, value = line.partition(":")
        if key.strip().lower() == "content-disposition":
            name = _header("Content-Disposition", value).get_param("name", header="Content-Disposition")
            if isinstance(name, str) and name.isidentifier() and name.isascii():
                return name, start + len(head) + len(blank)
    raise MultipartError(f"a part has no name that can be read; {REMEDY}")


def _header(key: str, value: str) -> Message:
    message = Message()
    message[key] = value
    return message
