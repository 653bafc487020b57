"""What ran where: commit, device, processor, versions."""

import os
import platform
import subprocess
from dataclasses import asdict
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from conicoid.engine import Renderer as Engine

_LIBRARIES: Final = ("conicoid", "numpy", "pyopencl", "mitsuba", "drjit", "numba")


def machine(engine: Engine) -> dict[str, Any]:
    """Plain values for JSON."""
    return {
        "commit": commit(),
        "device": asdict(engine.device),
        "processor": processor(),
        "load": os.getloadavg()[0],
        "system": platform.platform(),
        "python": platform.python_version(),
        "libraries": {name: found for name in _LIBRARIES if (found := _version(name))},
    }


def _version(name: str) -> str | None:
    try:
        return version(name)
    except ImportError:
        return None


def processor() -> str:
    """Its name, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")


def commit() -> str | None:
    """The checkout's commit, with + where files differ from it; None where this is not one."""
    here = str(files("conicoid_bench"))
    command = ["git", "-C", here, "describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() or None
