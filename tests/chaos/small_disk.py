"""A small disk that only some processes see, so that it can be filled: a tmpfs in a user and mount namespace."""

import errno
import subprocess
from pathlib import Path
from types import TracebackType
from typing import Self


class SmallDisk:
    """Needs util-linux and a kernel that lets users make namespaces; no root.

    Attributes:
        inside: words before a command that has to see the disk.
        path: where it is, for processes inside.
    """

    def __init__(self, path: Path, megabytes: int) -> None:
        path.mkdir()
        self.path = path
        script = f"mount -t tmpfs -o size={megabytes}m none '{path}' && echo mounted && exec sleep infinity"
        self._holder = subprocess.Popen(["unshare", "-Urm", "sh", "-c", script], stdout=subprocess.PIPE)
        assert self._holder.stdout is not None
        assert self._holder.stdout.readline() == b"mounted\n"
        self.inside = ("nsenter", f"--target={self._holder.pid}", "--user", "--mount", "--preserve-credentials")
        self._seen = Path(f"/proc/{self._holder.pid}/root") / path.relative_to("/")

    def fill(self) -> None:
        """Leave not a byte."""
        with (self._seen / "ballast").open("ab", buffering=0) as ballast:
            for size in (2**20, 2**12, 1):
                try:
                    while ballast.write(bytes(size)) == size:
                        pass
                except OSError as error:
                    if error.errno != errno.ENOSPC:
                        raise

    def free(self) -> None:
        """Give the room back."""
        (self._seen / "ballast").unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._holder.kill()
        self._holder.wait()
        self._holder.stdout.close()  # type: ignore[union-attr]
