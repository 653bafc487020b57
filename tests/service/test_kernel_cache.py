"""A kernel cache is one process' own, warm from the last one, and empty after a crash."""

import os
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Self

import pytest

TAKE = """
import os, sys
from conicoid_service.kernel_cache import take_slot
slot = take_slot(sys.argv[1], sys.argv[2] or None)
assert os.environ["POCL_CACHE_DIR"].startswith(str(slot))
assert os.environ["XDG_CACHE_HOME"].startswith(str(slot))
print(slot, flush=True)
sys.stdin.read()
"""


class Holder:
    """A process that holds a slot until it is let go."""

    def __init__(self, cache: Path, after: str = "") -> None:
        command = [sys.executable, "-c", TAKE, str(cache), after]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout
        self.slot = Path(self._process.stdout.readline().strip())

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()


def test_processes_at_once_have_slots_of_their_own(tmp_path: Path) -> None:
    with ExitStack() as stack:
        slots = [stack.enter_context(Holder(tmp_path)).slot for _ in range(3)]
    assert len(set(slots)) == 3


@pytest.mark.parametrize("killed", [False, True])
def test_a_slot_is_warm_for_its_next_holder(tmp_path: Path, killed: bool) -> None:
    with Holder(tmp_path) as first:
        (first.slot / "pocl" / "kernel.so").touch()
        if killed:
            first.kill()
    with Holder(tmp_path, after="SIGKILL" if killed else "") as second:
        assert second.slot == first.slot
        assert (second.slot / "pocl" / "kernel.so").exists()


@pytest.mark.parametrize("crash", ["SIGABRT", "SIGSEGV", "SIGBUS", "SIGILL"])
def test_a_slot_is_emptied_after_a_crash(tmp_path: Path, crash: str) -> None:
    with Holder(tmp_path) as first:
        (first.slot / "pocl" / "half-written.so").touch()
    with Holder(tmp_path, after=crash) as second:
        assert second.slot == first.slot
        assert not list((second.slot / "pocl").iterdir())


def test_a_folder_that_cannot_be_made_is_replaced_by_a_temporary_one(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with Holder(tmp_path / "file" / "below") as holder:
        assert (holder.slot / "pocl").is_dir()
        assert tmp_path not in holder.slot.parents
    assert not holder.slot.exists()


def test_the_tests_own_process_is_left_alone() -> None:
    assert "POCL_CACHE_DIR" not in os.environ
