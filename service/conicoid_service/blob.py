"""Bytes in an anonymous file, handed between processes as a descriptor.

The file has no name and lives in memory: it is gone with its last holder, whichever process dies, and it does not
count against `/dev/shm`, which containers keep at 64 MB.
"""

import io
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import BinaryIO, Self

CHUNK = 1 << 18
_BUFFER = 1 << 20
_LARGEST_READ = 1 << 30  # Linux reads less than 2 GiB at once


def _anonymous_descriptor() -> int:
    if hasattr(os, "memfd_create"):
        return os.memfd_create("conicoid")
    with tempfile.TemporaryFile(buffering=0) as file:  # other systems: a file that is unlinked already
        return os.dup(file.fileno())


class Blob:
    """One anonymous file; close it, or use it in a `with` statement."""

    def __init__(self, descriptor: int | None = None) -> None:
        """Take over `descriptor`, or make a new, empty file."""
        opened = _anonymous_descriptor() if descriptor is None else descriptor
        self.file: BinaryIO = os.fdopen(opened, "r+b", buffering=0)

    @classmethod
    def of(cls, data: bytes) -> Self:
        """A new file that holds `data`."""
        blob = cls()
        blob.append(data)
        return blob

    def append(self, data: bytes | memoryview) -> None:
        """Write `data` at the file's position, all of it."""
        view = memoryview(data)
        while view:
            view = view[self.file.write(view) :]

    @contextmanager
    def buffered(self) -> Iterator[BinaryIO]:
        """The file behind a buffer, for writers of many small pieces; it holds all of them afterwards."""
        stream = io.BufferedRandom(self.file, _BUFFER)  # type: ignore[arg-type]  # it is raw: see __init__
        try:
            yield stream
        finally:
            stream.detach()

    def shared(self) -> Self:
        """Another holder of the same file, which lasts until both are closed."""
        return type(self)(os.dup(self.fileno()))

    def read(self) -> bytes:
        """The whole content."""
        size = len(self)
        starts = range(0, size, _LARGEST_READ)
        # No room for more than there is: it would be mapped, and returned to the system, at every call.
        return b"".join(os.pread(self.fileno(), min(_LARGEST_READ, size - start), start) for start in starts)

    def chunks(self, size: int = CHUNK) -> Iterator[bytes]:
        """The whole content in pieces of at most `size` bytes; where others read the same file, nobody is disturbed."""
        start = 0
        while chunk := os.pread(self.fileno(), size, start):
            yield chunk
            start += len(chunk)

    def fileno(self) -> int:
        """The descriptor, which stays the blob's."""
        return self.file.fileno()

    def __len__(self) -> int:
        return os.fstat(self.file.fileno()).st_size

    def close(self) -> None:
        """Give the descriptor up; the last holder's close frees the memory."""
        self.file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
