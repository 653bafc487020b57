"""How many CPUs this process may really use: affinity and cgroup quotas, which OpenCL drivers do not look at."""

import math
import os
from pathlib import Path

from conicoid_service.cgroups import CGROUPS, MEMBERSHIP, folders, words


def usable_cpus(cgroups: Path = CGROUPS, membership: Path = MEMBERSHIP) -> int:
    """CPUs by the scheduler's affinity, limited by the CPU quota of every cgroup (v1 or v2) that holds this process.

    A quota of a CPU and a half counts as two: the half is used, at the price of some throttling.
    """
    affinity = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    found = folders("cpu", cgroups, membership)
    quotas = [quota for folder in found if (quota := _quota(folder)) is not None]
    return max(1, min([affinity, *(math.ceil(quota) for quota in quotas)]))


def _quota(folder: Path) -> float | None:
    """The folder's own quota in CPUs, if it has one."""
    if (found := words(folder / "cpu.max")) and found[0] != "max":
        return int(found[0]) / int(found[1])
    quota, period = words(folder / "cpu.cfs_quota_us"), words(folder / "cpu.cfs_period_us")
    if quota and period and int(quota[0]) > 0:
        return int(quota[0]) / int(period[0])
    return None
