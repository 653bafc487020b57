"""Files of the job store that were read lately, in this process' memory."""

from collections.abc import Iterator
from dataclasses import dataclass

from conicoid_service.blob import Blob
from conicoid_service.jobs.files import Files
from conicoid_service.recent import Recent


@dataclass(frozen=True)
class _Copy:
    blob: Blob


class Near:
    """`jobs.files.Files` that are fetched once and kept while there is room; for one reader at a time."""

    def __init__(self, far: Files, limit: int) -> None:
        """Keep up to `limit` bytes of the files of `far`."""
        self._far = far
        self._copies: Recent[_Copy] = Recent(limit)

    def close(self) -> None:
        """Give the copies up."""
        self._copies.close()

    def open(self, name: str) -> Blob | None:
        """As `Files.open`."""
        if (copy := self._copies.get(name)) is not None:
            return copy.blob.shared()
        blob = self._far.open(name)
        if blob is not None:
            self._copies.put(name, _Copy(blob.shared()))
        return blob

    def write(self, name: str, blob: Blob) -> None:
        """As `Files.write`."""
        self._far.write(name, blob)

    def size(self, name: str) -> int | None:
        """As `Files.size`."""
        return self._far.size(name)

    def remove(self, name: str) -> None:
        """As `Files.remove`."""
        self._copies.drop(name)
        self._far.remove(name)

    def touch(self, name: str) -> bool:
        """As `Files.touch`."""
        return self._far.touch(name)

    def names(self, older_than_ms: int) -> Iterator[str]:
        """As `Files.names`."""
        return self._far.names(older_than_ms)

    def is_older(self, name: str, than_ms: int) -> bool:
        """As `Files.is_older`."""
        return self._far.is_older(name, than_ms)

    def sweep(self, older_than_ms: int) -> None:
        """As `Files.sweep`."""
        self._far.sweep(older_than_ms)

    def link(self, name: str, seconds: float) -> str | None:
        """As `Files.link`."""
        return self._far.link(name, seconds)
