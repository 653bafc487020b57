"""How much memory there is, and a limit on what a process may take of it.

A process that meets its limit gets a `MemoryError`; one that meets the machine's or the container's is killed by the
kernel, and perhaps another in its place.
"""

import os
import resource
from pathlib import Path

from conicoid_service.cgroups import CGROUPS, MEMBERSHIP, folders, words
from conicoid_service.errors import OutOfMemoryError


def usable_memory(cgroups: Path = CGROUPS, membership: Path = MEMBERSHIP) -> int:
    """Bytes of the machine's memory, or of the smallest limit of the cgroups (v1 or v2) that hold this process."""
    physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    found = folders("memory", cgroups, membership)
    texts = [
        text for folder in found for name in ("memory.max", "memory.limit_in_bytes") for text in words(folder / name)
    ]
    return min([physical, *(int(text) for text in texts if text != "max")])


def limit_memory(limit: int) -> None:
    """Let this process have so many bytes of private memory; less where it may not have as many already."""
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    possible = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (possible, possible))


def out_of_memory() -> OutOfMemoryError:
    """What a request gets that met the limit."""
    limit, _ = resource.getrlimit(resource.RLIMIT_DATA)
    bound = "there is" if limit == resource.RLIM_INFINITY else f"the {limit:,} bytes that the process may have"
    return OutOfMemoryError(
        f"the request needs more memory than {bound}; ask for fewer pixels or quadrics, "
        "or have the operator raise CONICOID_RENDER_MEMORY_LIMIT or lower CONICOID_RENDER_PROCESSES"
    )
