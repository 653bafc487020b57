"""Jobs and frames as the store gives them out."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

State = Literal["queued", "running", "succeeded", "failed", "cancelled"]

STATES: Final[tuple[State, ...]] = ("queued", "running", "succeeded", "failed", "cancelled")
UNFINISHED: Final[tuple[State, ...]] = ("queued", "running")

Priority = Literal["normal", "high"]

# The most urgent first.
PRIORITIES: Final[Mapping[Priority, int]] = {"high": 1, "normal": 0}


@dataclass(frozen=True)
class Job:
    """A batch of views of the same quadrics.

    Attributes:
        id: sorts by time of creation; not to be guessed.
        owner: name of the API key that made it; "" where there are none.
        created_ms, started_ms, finished_ms, expires_ms: milliseconds since 1970, UTC; None if that is not known yet.
        frames_total, frames_done, frames_failed: all, those with an image, those that ended without one.
        quadrics_hash: names the quadrics' file.
        priority: see `PRIORITIES`.
        digest: of all that it means: requests with the same one ask for the same.
    """

    id: str
    owner: str
    state: State
    created_ms: int
    started_ms: int | None
    finished_ms: int | None
    expires_ms: int | None
    frames_total: int
    frames_done: int
    frames_failed: int
    quadrics_hash: str
    idempotency_key: str | None
    digest: str
    priority: int

    @property
    def ended(self) -> bool:
        """Whether nothing of it will be rendered any more."""
        return self.state not in UNFINISHED


@dataclass(frozen=True)
class Frame:
    """One view of a job.

    Attributes:
        number: from 0.
        ended_as: it was the n-th of its job to end, from 1; None while it has not.
        tag, bytes: of its image, None without one.
        error_code, error_detail: why it failed.
    """

    job_id: str
    number: int
    state: State
    ended_as: int | None
    tag: str | None
    bytes: int | None
    error_code: str | None
    error_detail: str | None


@dataclass(frozen=True)
class Unit:
    """What is rendered at a time.

    Attributes:
        number: of the frame.
        band: of the frame, from 1; 0 is the whole frame.
    """

    job_id: str
    number: int
    band: int


@dataclass(frozen=True)
class Claim(Unit):
    """A unit that this server is to render.

    Attributes:
        bands: into which the frame is cut; band 0 of such a frame is to be joined.
        view: camera and output of the frame, a line of JSON.
        attempts: how often it was taken, this time included.
    """

    bands: int
    owner: str
    quadrics_hash: str
    view: str
    scene_hash: str
    attempts: int


@dataclass(frozen=True)
class StoredImage:
    """An image on the disk.

    Attributes:
        tag: the entity tag without its quotes; names the file.
        sha256: of the bytes.
        scene_hash, refined, settled: as in `images.Image`.
    """

    tag: str
    bytes: int
    sha256: str
    scene_hash: str
    refined: int
    settled: int
