"""Jobs, their frames and their events, as the service tells of them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Self

from conicoid_client.errors import ClientError

_ID = re.compile(r"[0-9A-Za-z_-]{1,64}")
_ENDED = frozenset({"succeeded", "failed", "cancelled"})


@dataclass(frozen=True)
class Job:
    """A batch of frames that the service renders while nobody waits.

    Attributes:
        id: its name.
        state: `queued`, `running`, `succeeded`, `failed` or `cancelled`.
        created, started, finished: when, with time zone; None for what has not happened yet.
        expires: when its frames go; None before it has ended.
        frames_total: how many frames it has.
        frames_done: how many of them have an image.
        frames_failed: how many of them never will.
    """

    id: str
    state: str
    created: datetime | None
    started: datetime | None
    finished: datetime | None
    expires: datetime | None
    frames_total: int
    frames_done: int
    frames_failed: int

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it, but for its expiry."""
        return self.state in _ENDED

    @classmethod
    def read(cls, answer: Any) -> Self:
        """Raises ClientError: it is not a job."""
        try:
            return cls(
                id=checked_id(answer["id"]),
                state=_text(answer["state"]),
                created=_time(answer["created"]),
                started=_time(answer["started"]),
                finished=_time(answer["finished"]),
                expires=_time(answer["expires"]),
                frames_total=_count(answer["frames_total"]),
                frames_done=_count(answer["frames_done"]),
                frames_failed=_count(answer["frames_failed"]),
            )
        except (KeyError, TypeError, ValueError):
            raise ClientError("the service's answer is not a job; is this a Conicoid service?") from None


@dataclass(frozen=True)
class Frame:
    """One view of a job.

    Attributes:
        number: its place in the document's `cameras`, from 0.
        state: as a job's.
        etag: strong entity tag of its image; None while it has none.
        size: bytes of its image; None while it has none.
        error_code, error_detail: why it failed; None unless it has.
    """

    number: int
    state: str
    etag: str | None
    size: int | None
    error_code: str | None
    error_detail: str | None

    @classmethod
    def read(cls, answer: Any) -> Self:
        """Raises ClientError: it is not a frame."""
        try:
            error: Mapping[str, Any] = answer["error"] or {}
            return cls(
                number=_count(answer["frame"]),
                state=_text(answer["state"]),
                etag=None if answer["etag"] is None else _text(answer["etag"]),
                size=None if answer["bytes"] is None else _count(answer["bytes"]),
                error_code=_text(error["code"]) if error else None,
                error_detail=_text(error["detail"]) if error else None,
            )
        except (KeyError, TypeError, ValueError):
            raise ClientError("the service's answer is not a job's frame; is this a Conicoid service?") from None


@dataclass(frozen=True)
class Progress:
    """The job as it is now."""

    job: Job


@dataclass(frozen=True)
class FrameEnded:
    """A frame has an image, or never will.

    Attributes:
        id: what `Client.events` takes as `last_event_id` to go on after this one.
        frame: the frame.
        frames_done, frames_failed, frames_total: of its job.
    """

    id: str
    frame: Frame
    frames_done: int
    frames_failed: int
    frames_total: int

    @classmethod
    def read(cls, event_id: str, answer: Any) -> Self:
        """Raises ClientError: it is not one."""
        frame = Frame.read(answer)
        try:
            counts = {name: _count(answer[name]) for name in ("frames_done", "frames_failed", "frames_total")}
        except (KeyError, TypeError, ValueError):
            raise ClientError("the service's event does not count the job's frames") from None
        return cls(event_id, frame, **counts)


@dataclass(frozen=True)
class JobEnded:
    """The job has ended, and nothing follows."""

    job: Job


Event = Progress | FrameEnded | JobEnded


def checked_id(job_id: Any) -> str:
    """The id, which is safe in a path.

    Raises:
        ClientError: it cannot be a job's.
    """
    if not isinstance(job_id, str) or not _ID.fullmatch(job_id):
        raise ClientError(f"{job_id!r} is not a job's id; conicoid jobs list shows those there are")
    return job_id


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError
    return value


def _count(value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise TypeError
    return value


def _time(value: Any) -> datetime | None:
    return None if value is None else datetime.fromisoformat(_text(value))
