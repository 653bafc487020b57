"""The C library's heap: memory that a request has freed stays at hand for the next one."""

import ctypes
import sys
from typing import Final

# Parameters of glibc's mallopt(3).
_M_TRIM_THRESHOLD: Final = -1
_M_MMAP_THRESHOLD: Final = -3

_KEPT: Final = 64 * 2**20
_LARGEST: Final = 32 * 2**20  # which glibc allows


def keep_freed_memory() -> None:
    """Have this process keep up to 64 MiB that it has freed, in pieces of up to 32 MiB; nothing without glibc.

    By itself glibc returns the end of the heap as soon as it has twice the largest piece, and the system has to clear
    every page of it again at the next request.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None) if sys.platform == "linux" else None
    if mallopt is not None:
        mallopt(_M_TRIM_THRESHOLD, _KEPT)
        mallopt(_M_MMAP_THRESHOLD, _LARGEST)
