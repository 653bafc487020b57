"""Choosing a device, building for it, and what both sides believe about memory."""

from importlib.resources import files
from pathlib import Path

import numpy as np
import pyopencl
import pytest

from conicoid import device, probe
from conicoid.cast import _FRAME, DOUBT
from conicoid.device import find_device, list_devices
from conicoid.errors import DeviceError, KernelError
from conicoid.memory import Queue
from conicoid.program import build
from conicoid.setup import CLIP, GENERAL, PLANE, SLOT

DEVICES = [info.version for info in list_devices()]


def test_without_a_device_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(device, "_devices", list)
    assert list_devices() == []
    with pytest.raises(DeviceError, match=r"pip install conicoid\[pocl\].*pocl-opencl-icd"):
        find_device()


def test_a_device_that_is_not_there_is_told_with_those_that_are() -> None:
    with pytest.raises(DeviceError, match=r"CONICOID_DEVICE='no such device'.*Portable"):
        find_device("no such device")


@pytest.mark.parametrize("version", DEVICES)
def test_a_device_is_found_by_its_version_in_any_case(version: str) -> None:
    assert find_device(version.upper()).platform.version.strip() == version


@pytest.mark.parametrize("version", DEVICES)
def test_every_device_here_multiplies_and_adds_without_contraction(version: str) -> None:
    probe.check_arithmetic(Queue(find_device(version)))


def test_arithmetic_that_rounds_twice_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    # The kernel that a device without fma amounts to: an error term of 0.
    half = "return (dd){p, (double4)(0.0)};"
    whole = "return (dd){p, fma(a, b, -p)};"
    read = Path.read_text
    monkeypatch.setattr(Path, "read_text", lambda self, **keywords: read(self, **keywords).replace(whole, half))
    with pytest.raises(DeviceError, match="true fma"):
        probe.check_arithmetic(Queue(find_device()))


def test_a_kernel_that_does_not_build_is_told_with_file_and_line() -> None:
    with pytest.raises(KernelError, match=r"lanes\.h:(?s:.*)define LANES"):
        build(Queue(find_device()).context, ["lanes.h"], {"REAL_BITS": 64, "EXACT": 0})


@pytest.mark.parametrize("version", DEVICES)
def test_host_and_kernels_lay_out_records_alike(version: str) -> None:
    queue = Queue(find_device(version))
    folder = files("conicoid") / "kernels"
    names = ("records.h", "lanes.h", "polynomials.h", "tile.h")
    source = "".join((folder / name).read_text(encoding="utf-8") for name in names)
    source += """
    __kernel void sizes(__global long *size)
    {
        size[0] = sizeof(slot_record); size[1] = sizeof(general_record); size[2] = sizeof(clip_record);
        size[3] = sizeof(frame); size[4] = sizeof(doubtful_pixel); size[5] = sizeof(plane_record);
    }
    """
    program = pyopencl.Program(queue.context, source).build(["-DREAL_BITS=64", "-DLANES=4", "-DEXACT=1"])
    size = np.zeros(6, dtype=np.int64)
    queue.run(program.sizes, 1, queue.in_place(size))
    assert size.tolist() == [record.itemsize for record in (SLOT, GENERAL, CLIP, _FRAME, DOUBT, PLANE)]
