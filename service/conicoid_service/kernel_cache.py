"""A folder of compiled kernels for this process alone, warm from earlier ones.

PoCL has crashed on caches that processes share, and aborts on a cache that a crash left half-written. So the cache
is a row of numbered slots: a process holds the lock of one for as long as it lives, and finds there what the slot's
last holder compiled. After a crash the slot is emptied first.
"""

import atexit
import fcntl
import os
import shutil
import tempfile
from pathlib import Path

CRASHES = frozenset({"SIGABRT", "SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE"})


def take_slot(cache_dir: str, after: str | None) -> Path:
    """Lock the first free slot and point the OpenCL libraries at it; to be called before they are loaded.

    Args:
        cache_dir: the folder of the slots; a temporary folder takes its place where it cannot be written.
        after: how the process ended whose place this one takes, as in `SIGABRT`.
    """
    try:
        slot = _lock_first_free(Path(cache_dir) / "kernels")
    except OSError:
        slot = Path(tempfile.mkdtemp(prefix="conicoid-kernels-"))
        atexit.register(shutil.rmtree, slot, ignore_errors=True)
    if after in CRASHES:
        for entry in ("pocl", "xdg"):
            shutil.rmtree(slot / entry, ignore_errors=True)
    for entry, name in (("pocl", "POCL_CACHE_DIR"), ("xdg", "XDG_CACHE_HOME")):  # pyopencl's cache is under XDG's
        (slot / entry).mkdir(exist_ok=True)
        os.environ[name] = str(slot / entry)
    return slot


def _lock_first_free(folder: Path) -> Path:
    number = 0
    while not _lock(folder / str(number)):
        number += 1
    return folder / str(number)


def _lock(slot: Path) -> bool:
    """Try to lock the slot; the descriptor stays open, and so the lock held, until this process ends."""
    slot.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(slot / "lock", os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        return False
    return True
