"""Where the files of the job store are: in a directory, or in a bucket of an object store."""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol
from urllib.parse import unquote, urlsplit

from conicoid_service.blob import Blob
from conicoid_service.errors import StoreError
from conicoid_service.jobs.folder import Folder


class Files(Protocol):
    """Files by name, each written once and never changed: whole or not there. For any thread."""

    def write(self, name: str, blob: Blob) -> None:
        """Write a file, safe under its name when this returns; one that is there already is replaced.

        Raises:
            OSError: it is not taken; nothing is left then.
        """
        ...

    def open(self, name: str) -> Blob | None:
        """The file, which the caller closes; None if it is not there. What is open can be read after it was removed."""
        ...

    def size(self, name: str) -> int | None:
        """Bytes of a file; None if it is not there."""
        ...

    def remove(self, name: str) -> None:
        """Remove a file, if it is there."""
        ...

    def touch(self, name: str) -> bool:
        """Whether a file is there and will stay for an hour, whatever is swept; if not, write it."""
        ...

    def names(self, older_than_ms: int) -> Iterator[str]:
        """The names of all files written or touched before a time."""
        ...

    def is_older(self, name: str, than_ms: int) -> bool:
        """Whether a file is there and was written or touched before a time, not after."""
        ...

    def sweep(self, older_than_ms: int) -> None:
        """Remove what dead writers left half written."""
        ...

    def link(self, name: str, seconds: float) -> str | None:
        """Where anybody may read the file, for some seconds; None if there is no such place."""
        ...


def files_at(place: str, kind: str, media_type: str) -> Files:
    """The files of a kind, such as `images`.

    Args:
        place: URL of a bucket with a prefix, `s3://bucket/prefix`, or of a directory, `file:///mnt/share`.
        kind: what comes behind the prefix.
        media_type: what an object store says that they are.
    Raises:
        StoreError: there is no such place, or it cannot be had.
    """
    parts = urlsplit(place)
    if parts.scheme == "file":
        root = Path(unquote(parts.path))
        try:
            root.stat()  # not made: a directory that is missing is one that is not mounted
            return Folder(root / kind)
        except OSError as error:
            raise StoreError(f"{root}: files cannot be kept here ({error.strerror}); see `object_store`") from None
    from conicoid_service.jobs.bucket import Bucket  # its library is an extra

    return Bucket(place, kind, media_type)
