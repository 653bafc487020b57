"""Which OpenCL device to run on: listing, choice by name and version, and what each platform rewards.

This module, `program` and the stages that launch kernels are the only ones that import pyopencl.
"""

import os
import re
from dataclasses import asdict, dataclass
from typing import Any

import pyopencl

from conicoid.errors import DeviceError

INSTALL_HINT = (
    "install a CPU driver with `pip install conicoid[pocl]` (which links kernels with Debian's `gcc` and `libc6-dev`) "
    "or Debian's package `pocl-opencl-icd`"
)


@dataclass(frozen=True)
class DeviceInfo:
    """One OpenCL device as the driver describes it.

    Attributes:
        platform, version: platform name and full version string.
        name: device name.
        compute_units: threads the driver runs kernels on.
        global_memory, largest_buffer: bytes.
        float64: whether the device computes in binary64; the engine needs it.
    """

    platform: str
    version: str
    name: str
    compute_units: int
    global_memory: int
    largest_buffer: int
    float64: bool

    @property
    def label(self) -> str:
        """The text that `CONICOID_DEVICE` is searched in."""
        return f"{self.platform} {self.version} {self.name}"

    @property
    def pocl(self) -> tuple[int, int] | None:
        """PoCL's (major, minor) version, or None on another platform."""
        found = re.search(r"PoCL (\d+)\.(\d+)", self.version)
        return (int(found[1]), int(found[2])) if found else None

    @property
    def double_lanes(self) -> int:
        """Lanes of a binary64 vector in the kernels; binary32 has twice as many.

        PoCL 3.0 (LLVM 14) aborts on 512-bit vectors on AVX-512 machines; from 3.1 on they are faster there and
        equal elsewhere. `native_vector_width` says 16 floats everywhere and is no guide.
        """
        return 8 if self.pocl is not None and self.pocl >= (3, 1) else 4

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self)


def list_devices() -> list[DeviceInfo]:
    """Every OpenCL device of every platform, in the loader's order; empty where there is no driver."""
    return [describe(device) for device in _devices()]


def find_device(selector: str | None = None) -> "pyopencl.Device":
    """The device to run on.

    Args:
        selector: part of "platform version name", in any case, as in `PoCL 3.1`; None reads `CONICOID_DEVICE`.
            Empty: PoCL's oldest version first (the embedded default), else the first device
            with binary64.
    Raises:
        DeviceError: no device at all, none with binary64, or none that matches.
    """
    asked = os.environ.get("CONICOID_DEVICE", "") if selector is None else selector
    devices = _devices()
    if not devices:
        raise DeviceError(f"no OpenCL device was found; {INSTALL_HINT}")
    capable = [device for device in devices if describe(device).float64]
    if not capable:
        raise DeviceError(f"no OpenCL device here computes in binary64, which the engine needs; {INSTALL_HINT}")
    matching = [device for device in capable if asked.lower() in describe(device).label.lower()]
    if not matching:
        known = "; ".join(describe(device).label for device in capable)
        raise DeviceError(f"no OpenCL device matches CONICOID_DEVICE={asked!r}; these are here: {known}")
    return min(matching, key=_preference)


def describe(device: "pyopencl.Device") -> DeviceInfo:
    """The facts of one device."""
    return DeviceInfo(
        platform=device.platform.name.strip(),
        version=device.platform.version.strip(),
        name=device.name.strip(),
        compute_units=int(device.max_compute_units),
        global_memory=int(device.global_mem_size),
        largest_buffer=int(device.max_mem_alloc_size),
        float64="cl_khr_fp64" in device.extensions.split(),
    )


def _devices() -> list["pyopencl.Device"]:
    try:
        platforms = pyopencl.get_platforms()
    except pyopencl.LogicError:
        # The loader answers an empty installation with an error, not with an empty list.
        return []
    return [device for platform in platforms for device in platform.get_devices()]


def _preference(device: "pyopencl.Device") -> tuple[int, tuple[int, int]]:
    pocl = describe(device).pocl
    return (0, pocl) if pocl else (1, (0, 0))
