"""The service's settings: typed, read from `CONICOID_...` environment variables and a file, checked at start."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Final, Self

from conicoid_service.access.keys import Keys
from conicoid_service.errors import SettingsError
from conicoid_service.setting_texts import (
    broker_url,
    database_url,
    log_format,
    object_store,
    parse_origins,
    read_file,
    text_of,
    value_of,
)

CONFIG = "CONICOID_CONFIG"


def _cache_dir() -> Path:
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "conicoid"


def _data_dir() -> Path:
    base = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(base) / "conicoid"


def _about(
    kind: Callable[[str], Any], meaning: str, at_least: float | None = None, *, secret: bool = False
) -> dict[str, Any]:
    return {"kind": kind, "meaning": meaning, "at_least": at_least, "secret": secret}


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
    render_memory_limit: int = field(default=0, metadata=_about(int, "bytes for a render process", 0))
    render_recycle_after: int = field(default=10_000, metadata=_about(int, "requests in a render process's life", 0))
    owner_queue_length: int = field(default=16, metadata=_about(int, "requests of one owner that may wait", 0))
    data_dir: Path = field(default_factory=_data_dir, metadata=_about(Path, "folder for jobs and their images"))
    store_limit: int = field(default=16 * 2**30, metadata=_about(int, "bytes of images on the disk", 0))
    result_lifetime_s: float = field(default=7 * 86400.0, metadata=_about(float, "seconds that ended jobs are kept", 1))
    frame_limit: int = field(default=10_000, metadata=_about(int, "frames in a job", 1))
    job_pixel_limit: int = field(default=10**11, metadata=_about(int, "pixels rendered in all frames of a job", 1))
    owner_frame_limit: int = field(default=100_000, metadata=_about(int, "frames of one owner that have not ended", 1))
    api_keys: Keys = field(default=Keys(), metadata=_about(Keys.parse, "API keys that are let in", secret=True))
    owner_requests: int = field(default=64, metadata=_about(int, "requests of one API key at once", 1))
    cors_origins: tuple[str, ...] = field(default=(), metadata=_about(parse_origins, "web pages that may read answers"))
    connection_limit: int = field(default=1000, metadata=_about(int, "open connections", 1))
    head_timeout_s: float = field(default=20.0, metadata=_about(float, "seconds for a request's head", 0.001))
    body_timeout_s: float = field(default=30.0, metadata=_about(float, "seconds without a byte of a body", 0.001))
    log_format: str = field(default="text", metadata=_about(log_format, "format of log lines, text or json"))
    send_timeout_s: float = field(
        default=60.0, metadata=_about(float, "seconds in which an answer stands still", 0.001)
    )

    database_url: str = field(
        default="", metadata=_about(database_url, "PostgreSQL database of a farm's jobs", secret=True)
    )
    broker_url: str = field(default="", metadata=_about(broker_url, "RabbitMQ of a farm", secret=True))
    object_store: str = field(default="", metadata=_about(object_store, "bucket or directory of a farm's files"))
    download_redirect_s: float = field(default=0.0, metadata=_about(float, "seconds that links to images are good", 0))
    band_pixels: int = field(default=2**24, metadata=_about(int, "pixels of a frame rendered at a time in a job", 1))
    worker_port: int = field(default=0, metadata=_about(int, "port of a worker's probes and metrics; 0 is none", 0))

    def __post_init__(self) -> None:
        """Raise SettingsError where settings do not go together."""
        given = {variable(name): bool(getattr(self, name)) for name in ("database_url", "broker_url", "object_store")}
        if any(given.values()) and not all(given.values()):
            missing = ", ".join(name for name, is_given in given.items() if not is_given)
            raise SettingsError(f"{missing}: not set, and a farm needs all of {', '.join(given)}; set all or none")

    @property
    def farm(self) -> bool:
        """Whether jobs are rendered by workers elsewhere."""
        return bool(self.broker_url)

    @classmethod
    def from_environment(cls, environment: Mapping[str, str] = os.environ, file: str | None = None) -> Self:
        """The defaults; what a file says instead; what the environment says instead of either.

        Args:
            environment: variables; an empty one is as good as none.
            file: a TOML file; None for the one that `CONICOID_CONFIG` names, if it does.
        Raises:
            SettingsError: a value is of the wrong type or out of range, or the file is unusable or has unknown keys.
        """
        path = file or environment.get(CONFIG)
        written = read_file(path) if path else {}
        known = {one.name: one.metadata for one in fields(cls)}
        if unknown := written.keys() - known.keys():
            raise SettingsError(f"{path}: {min(unknown)} is no setting; the settings are {', '.join(sorted(known))}")
        values = {}
        for name, about in known.items():
            if text := environment.get(variable(name)):
                values[name] = value_of(variable(name), text, **about)
            elif name in written:
                place = f"{path}: {name}"
                text = text_of(place, written[name], about["kind"], about["secret"])
                values[name] = value_of(place, text, **about)
        return cls(**values)


_SECRETS: Final = tuple(one.name for one in fields(Settings) if one.metadata["secret"])


def forget_secrets() -> None:
    """Take what is secret out of the environment: no child needs it."""
    for name in _SECRETS:
        os.environ.pop(variable(name), None)


def variable(name: str) -> str:
    """The environment variable of a setting."""
    return f"CONICOID_{name.upper()}"
