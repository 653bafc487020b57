"""The service's settings: typed, read from `CONICOID_...` environment variables, checked at start."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Self

from conicoid_service.errors import SettingsError


def _cache_dir() -> Path:
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "conicoid"


def _data_dir() -> Path:
    base = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(base) / "conicoid"


def _about(kind: Callable[[str], Any], meaning: str, at_least: float | None = None) -> dict[str, Any]:
    return {"kind": kind, "meaning": meaning, "at_least": at_least}


@dataclass(frozen=True)
class Settings:
    """What an operator may choose; `docs/http.md` lists the fields with their variables."""

    body_limit: int = field(default=256 * 2**20, metadata=_about(int, "bytes in a request's body", 1))
    quadric_limit: int = field(default=2_000_000, metadata=_about(int, "quadrics in a scene", 1))
    pixel_limit: int = field(default=67_000_000, metadata=_about(int, "pixels rendered in a frame", 1))
    kept_limit: int = field(default=512 * 2**20, metadata=_about(int, "bytes of kept scenes", 0))
    image_cache_limit: int = field(default=256 * 2**20, metadata=_about(int, "bytes of images kept for later", 0))
    queue_length: int = field(default=32, metadata=_about(int, "requests that may wait for each process", 0))
    deadline_s: float = field(default=60.0, metadata=_about(float, "seconds for a request, each attempt", 0.001))
    start_deadline_s: float = field(default=120.0, metadata=_about(float, "seconds for a process to start", 0.001))
    device: str = field(default="", metadata=_about(str, "words of the OpenCL platform's and device's names"))
    threads: int = field(default=0, metadata=_about(int, "threads that render; 0 means one per usable CPU", 0))
    cache_dir: Path = field(default_factory=_cache_dir, metadata=_about(Path, "folder for compiled kernels"))

    render_processes: int = field(default=1, metadata=_about(int, "render processes", 1))
    data_dir: Path = field(default_factory=_data_dir, metadata=_about(Path, "folder for jobs and their images"))
    store_limit: int = field(default=16 * 2**30, metadata=_about(int, "bytes of images on the disk", 0))
    result_lifetime_s: float = field(default=7 * 86400.0, metadata=_about(float, "seconds that ended jobs are kept", 1))
    frame_limit: int = field(default=10_000, metadata=_about(int, "frames in a job", 1))
    job_pixel_limit: int = field(default=10**11, metadata=_about(int, "pixels rendered in all frames of a job", 1))
    owner_frame_limit: int = field(default=100_000, metadata=_about(int, "frames of one owner that have not ended", 1))

    @classmethod
    def from_environment(cls, environment: Mapping[str, str] = os.environ) -> Self:
        """The defaults, with what the environment says instead.

        Raises:
            SettingsError: a variable's value is of the wrong type or out of range.
        """
        values = {}
        for one in fields(cls):
            text = environment.get(variable(one.name))
            if text:
                values[one.name] = _read(variable(one.name), text, **one.metadata)
        return cls(**values)


def variable(name: str) -> str:
    """The environment variable of a setting."""
    return f"CONICOID_{name.upper()}"


def _read(place: str, text: str, kind: Callable[[str], Any], meaning: str, at_least: float | None) -> Any:
    try:
        value = kind(text)
    except ValueError:
        raise SettingsError(f"{place}: {text!r} is not a number; it sets the {meaning}") from None
    if at_least is not None and not at_least <= value < float("inf"):
        raise SettingsError(f"{place}: {text!r} is not a finite number >= {at_least:g}; it sets the {meaning}")
    return value
