"""The CPUs that quotas and affinity leave, whichever cgroup version sets them, at whichever level."""

import os
from pathlib import Path

import pytest

from conicoid_service.cpus import usable_cpus

AFFINITY = 8


@pytest.fixture(autouse=True)
def affinity(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(AFFINITY)))


def machine(root: Path, membership: str, files: dict[str, str]) -> int:
    """What is usable on a machine with this membership and these files under /sys/fs/cgroup."""
    for name, content in files.items():
        path = root / "cgroup" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    (root / "membership").write_text(membership)
    return usable_cpus(root / "cgroup", root / "membership")


@pytest.mark.parametrize(
    ("membership", "files"),
    [
        ("0::/\n", {"cpu.max": "100000 100000\n"}),
        ("0::/a/b\n", {"a/b/cpu.max": "max 100000", "a/cpu.max": "50000 100000"}),
        ("0::/host/path/not/here\n", {"cpu.max": "10000 100000"}),
        ("4:cpu,cpuacct:/\n", {"cpu,cpuacct/cpu.cfs_quota_us": "100000", "cpu,cpuacct/cpu.cfs_period_us": "100000"}),
        ("4:cpu,cpuacct:/x\n", {"cpu/x/cpu.cfs_quota_us": "5000", "cpu/x/cpu.cfs_period_us": "100000"}),
        ("4:cpu:/\n0::/a\n", {"unified/a/cpu.max": "100000 100000", "cpu/cpu.cfs_quota_us": "-1"}),
    ],
)
def test_a_quota_of_one_cpu_or_less_leaves_one(tmp_path: Path, membership: str, files: dict[str, str]) -> None:
    assert machine(tmp_path, membership, files) == 1


@pytest.mark.parametrize(
    ("membership", "files"),
    [
        ("", {}),
        ("0::/\n", {}),
        ("0::/\n", {"cpu.max": "max 100000\n"}),
        ("4:cpu:/\n", {"cpu/cpu.cfs_quota_us": "-1", "cpu/cpu.cfs_period_us": "100000"}),
        ("7:cpuset:/\n", {"cpu/cpu.cfs_quota_us": "100000", "cpu/cpu.cfs_period_us": "100000"}),
        ("0::/\n", {"cpu.max": f"{AFFINITY * 100000 + 1} 100000"}),
    ],
)
def test_without_a_quota_that_binds_the_affinity_counts(tmp_path: Path, membership: str, files: dict[str, str]) -> None:
    assert machine(tmp_path, membership, files) == AFFINITY


def test_a_part_of_a_cpu_counts_as_one(tmp_path: Path) -> None:
    assert machine(tmp_path, "0::/\n", {"cpu.max": "110000 100000"}) == 2


def test_a_system_without_cgroups_has_its_affinity(tmp_path: Path) -> None:
    assert usable_cpus(tmp_path / "none", tmp_path / "none") == AFFINITY
