"""Memory that was freed costs no pages when it is wanted again."""

import platform
import subprocess
import sys

import pytest

# Three pieces at once: glibc would keep two of them.
_FAULTS = """
import resource
from conicoid_service.heap import keep_freed_memory

def work():
    pieces = [bytearray(2**23) for _ in range(3)]

keep_freed_memory()
work()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(10):
    work()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="only glibc has a heap to be told so")
def test_memory_freed_by_one_request_is_not_fetched_again_by_the_next() -> None:
    faults = subprocess.run([sys.executable, "-c", _FAULTS], check=True, capture_output=True, text=True).stdout
    # The three pieces are 6,144 pages.
    assert int(faults) < 100
