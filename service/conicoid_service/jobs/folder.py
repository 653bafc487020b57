"""Files of the job store: whole or not there, whatever dies while they are written."""

import os
import secrets
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from conicoid_service.blob import Blob

_TEMPORARY: Final = "incoming"


class Folder:
    """Files by name, each written once and never changed.

    Args:
        path: made if it is not there.
    Raises:
        OSError: it cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._incoming = path / _TEMPORARY
        self._incoming.mkdir(parents=True, exist_ok=True)

    def write(self, name: str, blob: Blob) -> None:
        """Write a file, on the disk under its name when this returns; one that is there already is replaced.

        Raises:
            OSError: the disk is full or not writable; nothing is left then.
        """
        place = self._place(name)
        temporary = self._incoming / f"{name}.{secrets.token_hex(8)}"
        try:
            with Blob(os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)) as file:
                for chunk in blob.chunks():
                    file.append(chunk)
                os.fsync(file.fileno())
            place.parent.mkdir(exist_ok=True)
            temporary.rename(place)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
        _sync_folder(place.parent)

    def open(self, name: str) -> Blob | None:
        """The file, which the caller closes; None if it is not there. What is open can be read after it was removed."""
        try:
            return Blob(os.open(self._place(name), os.O_RDONLY | os.O_CLOEXEC))
        except FileNotFoundError:
            return None

    def size(self, name: str) -> int | None:
        """Bytes of a file; None if it is not there."""
        try:
            return self._place(name).stat().st_size
        except FileNotFoundError:
            return None

    def remove(self, name: str) -> None:
        """Remove a file, if it is there."""
        self._place(name).unlink(missing_ok=True)

    def touch(self, name: str) -> bool:
        """Make a file as young as if it were written now, so that no sweep takes it; whether it is there."""
        try:
            os.utime(self._place(name))
        except FileNotFoundError:
            return False
        return True

    def names(self, older_than_ms: int) -> Iterator[str]:
        """The names of all files written or touched before a time."""
        for part in self._path.iterdir():
            if part != self._incoming:
                yield from (file.name for file in _older(part, older_than_ms))

    def is_older(self, name: str, than_ms: int) -> bool:
        """Whether a file is there and was written or touched before a time, not after."""
        return _is_older(self._place(name), than_ms)

    def sweep(self, older_than_ms: int) -> None:
        """Remove what dead writers left half written."""
        for file in _older(self._incoming, older_than_ms):
            file.unlink(missing_ok=True)

    def link(self, name: str, seconds: float) -> str | None:  # noqa: ARG002
        """None: a directory is nobody's to read but the service's."""
        return None

    def _place(self, name: str) -> Path:
        return self._path / name[:2] / name


def _older(folder: Path, than_ms: int) -> Iterator[Path]:
    return (file for file in folder.iterdir() if _is_older(file, than_ms))


def _is_older(file: Path, than_ms: int) -> bool:
    with suppress(FileNotFoundError):  # it is gone meanwhile
        return file.stat().st_mtime_ns < than_ms * 1_000_000
    return False


def _sync_folder(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
