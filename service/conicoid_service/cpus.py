"""How many CPUs this process may really use: affinity and cgroup quotas, which OpenCL drivers do not look at."""

import math
import os
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

CGROUPS = Path("/sys/fs/cgroup")
MEMBERSHIP = Path("/proc/self/cgroup")


def usable_cpus(cgroups: Path = CGROUPS, membership: Path = MEMBERSHIP) -> int:
    """CPUs by the scheduler's affinity, limited by the CPU quota of every cgroup (v1 or v2) that holds this process.

    A quota of a CPU and a half counts as two: the half is used, at the price of some throttling.
    """
    affinity = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    quotas = [quota for folder in _folders(cgroups, membership) if (quota := _quota(folder)) is not None]
    return max(1, min([affinity, *(math.ceil(quota) for quota in quotas)]))


def _folders(cgroups: Path, membership: Path) -> Iterator[Path]:
    """The folders of this process' cgroups and all their ancestors; a quota may be set at any level."""
    try:
        lines = membership.read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            mounts = [cgroups, cgroups / "unified"]
        elif "cpu" in controllers.split(","):
            mounts = [cgroups / controllers, cgroups / "cpu"]
        else:
            continue
        # Inside a container the path may be the host's, which is not there: then only the root is found.
        inside = PurePosixPath(path.lstrip("/"))
        for mount in mounts:
            yield from (mount / level for level in (inside, *inside.parents))


def _quota(folder: Path) -> float | None:
    """The folder's own quota in CPUs, if it has one."""
    if (words := _words(folder / "cpu.max")) and words[0] != "max":
        return int(words[0]) / int(words[1])
    quota, period = _words(folder / "cpu.cfs_quota_us"), _words(folder / "cpu.cfs_period_us")
    if quota and period and int(quota[0]) > 0:
        return int(quota[0]) / int(period[0])
    return None


def _words(file: Path) -> list[str]:
    try:
        return file.read_text().split()
    except OSError:
        return []
