"""What the service's tests share."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


def descriptors() -> set[str]:
    """What this process holds open that a child or a blob may have left: sockets, pipes, anonymous files."""
    held = set()
    for entry in Path("/proc/self/fd").iterdir():
        try:
            target = os.readlink(entry)
        except FileNotFoundError:
            continue  # the listing's own descriptor
        if target.startswith(("/memfd:conicoid", "socket:", "pipe:")):
            held.add(target)
    return held


def children() -> set[int]:
    """Processes whose parent is this one, zombies included."""
    found = set()
    for thread in Path("/proc/self/task").iterdir():
        found |= {int(pid) for pid in (thread / "children").read_text().split()}
    return found


@pytest.fixture
def nothing_left() -> Iterator[None]:
    """Fails a test that leaves a process, a zombie, a socket or a blob behind."""
    before = children(), descriptors()
    yield
    assert children() <= before[0]
    assert descriptors() <= before[1]
