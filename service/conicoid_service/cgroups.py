"""The cgroups (v1 and v2) that hold this process, whose limits neither Python nor OpenCL drivers look at."""

from collections.abc import Iterator
from pathlib import Path, PurePosixPath

CGROUPS = Path("/sys/fs/cgroup")
MEMBERSHIP = Path("/proc/self/cgroup")


def folders(controller: str, cgroups: Path, membership: Path) -> Iterator[Path]:
    """The folders of this process' cgroups of a controller and all their ancestors; a limit may be at any level."""
    try:
        lines = membership.read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            mounts = [cgroups, cgroups / "unified"]
        elif controller in controllers.split(","):
            mounts = [cgroups / controllers, cgroups / controller]
        else:
            continue
        # Inside a container the path may be the host's, which is not there: then only the root is found.
        inside = PurePosixPath(path.lstrip("/"))
        for mount in mounts:
            yield from (mount / level for level in (inside, *inside.parents))


def words(file: Path) -> list[str]:
    """What a limit's file says; nothing where it is not."""
    try:
        return file.read_text().split()
    except OSError:
        return []
