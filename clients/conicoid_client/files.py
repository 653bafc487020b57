"""Reading and writing files and standard streams: `-` is standard input or output."""

import os
import secrets
import shutil
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

STANDARD = "-"


def read(source: str) -> bytes:
    """Everything in a file, or on standard input.

    Raises:
        OSError: it cannot be read.
    """
    if source != STANDARD:
        return Path(source).read_bytes()
    if sys.stdin is None:
        raise OSError("standard input is closed")
    return sys.stdin.buffer.read()


def check_writable(target: str) -> None:
    """Raise OSError now if write(target, ...) could not work: called before the long work, not after it."""
    if target == STANDARD:
        if sys.stdout is None:
            raise OSError("standard output is closed")
        return
    path = Path(os.path.realpath(target))
    if path.is_dir():
        raise IsADirectoryError(f"{target} is a directory; name a file")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"the directory {path.parent} does not exist; make it first")
    needed = [path] if path.exists() else []
    if _replaceable(path):
        needed.append(path.parent)
    if not all(os.access(place, os.W_OK) for place in needed):
        raise PermissionError(f"{target} cannot be written: permission denied")


def write(target: str, data: bytes | memoryview) -> None:
    """Write a whole file or nothing; a reader, or a crash, never meets half of one.

    A regular file is written under another name beside its target and then renamed. Devices and pipes are
    written as they are.

    Raises:
        OSError: it cannot be written; the old file is still there.
    """
    if target == STANDARD:
        check_writable(target)
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return
    path = Path(os.path.realpath(target))
    if not _replaceable(path):
        path.write_bytes(data)
        return
    with replacing(path) as file:
        file.write(data)


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """A new file that takes the place of `path` when all of it is on the disk, or leaves no trace.

    Raises:
        OSError: it cannot be written; the old file is still there.
    """
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        with beside.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, beside)
        beside.replace(path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


def say(text: str) -> None:
    """Print a command's result on standard output.

    Raises:
        OSError: it is closed, full, or nobody reads it.
    """
    check_writable(STANDARD)
    print(text, flush=True)


def _replaceable(path: Path) -> bool:
    return not path.exists() or stat.S_ISREG(path.stat().st_mode)
