"""A job's frames as files in a folder, of which those that are there already are not fetched again."""

import errno
import hashlib
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from conicoid_client.files import replacing
from conicoid_client.jobs import Frame

if TYPE_CHECKING:
    from conicoid_client.client import Client

LIST = "frames.jsonl"


class FrameFiles:
    """The files `frame-00000.exr`, `frame-00001.exr`, ... of a folder, and `frames.jsonl`, which says what they are.

    A file is whole or not there. The list has a line of JSON for each that was fetched: `file`, `job`, `etag`,
    `sha256`. Equal tags mean equal bytes, so a file that has the SHA-256 of a line with the frame's tag is the frame,
    whichever job it came from.

    Raises:
        OSError: the folder, which is made where it is missing, cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._list = folder, folder / LIST
        folder.mkdir(parents=True, exist_ok=True)
        # Known before the long work, not after it.
        if not os.access(folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
        self._digests: dict[tuple[str, str], str] = {}
        if self._list.exists():
            with self._list.open("a+b") as file:
                _end_line(file)
            self._digests = dict(_read(self._list))

    def path(self, number: int) -> Path:
        """Where a frame is."""
        return self._folder / f"frame-{number:05}.exr"

    def save(self, client: "Client", job_id: str, frame: Frame) -> bool:
        """Have a frame's image in its file; whether it had to be fetched.

        Raises:
            OSError: it cannot be written; the old file is still there.
            ClientError: as `Client.save_frame`.
        """
        path = self.path(frame.number)
        if frame.etag is not None and self._is_there(path, frame.etag):
            return False
        with replacing(path) as file:
            etag = client.save_frame(job_id, frame.number, file)
            file.flush()
            digest = _sha256(Path(file.name))
        if etag is not None:
            self._digests[path.name, etag] = digest
            line = json.dumps({"file": path.name, "job": job_id, "etag": etag, "sha256": digest})
            with self._list.open("ab") as file:
                file.write(f"{line}\n".encode())
        return True

    def _is_there(self, path: Path, etag: str) -> bool:
        digest = self._digests.get((path.name, etag))
        return digest is not None and path.is_file() and _sha256(path) == digest


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _end_line(file: BinaryIO) -> None:
    """What was being written when the machine stopped cannot spoil the next line."""
    if file.seek(0, 2) and (file.seek(-1, 2), file.read(1))[1] != b"\n":
        file.write(b"\n")


def _read(path: Path) -> list[tuple[tuple[str, str], str]]:
    """((file, etag), sha256) of every line that is whole."""
    found = []
    for line in path.read_text(errors="replace").splitlines():
        try:
            entry = json.loads(line)
            found.append(((str(entry["file"]), str(entry["etag"])), str(entry["sha256"])))
        except (ValueError, KeyError, TypeError):
            continue
    return found
