"""A job's progress as server-sent events.

The frames of a job are numbered in the order in which they end, and the number is the event's id: what a client that
comes back has missed is known from the last number that it saw, on any server, after any restart.
"""

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

import orjson
from fastapi.sse import format_sse_event

from conicoid_service.errors import StorageError
from conicoid_service.jobs.documents import frame_document, job_document
from conicoid_service.jobs.records import Job

if TYPE_CHECKING:
    from conicoid_service.jobs.jobs import Jobs

END: Final = "end"
# How often to look whether another server has changed the job.
_LOOK_S: Final = 1.0
_PROGRESS_S: Final = 0.5
_SILENCE_S: Final = 15.0
_AT_ONCE: Final = 500


async def job_events(jobs: "Jobs", job_id: str, ended: int) -> AsyncIterator[bytes]:
    """Events of a job from the one after its first `ended` frames on, until its end or the server's."""
    told: Job | None = None
    told_at = sent_at = time.monotonic()
    with jobs.bell.watching(job_id) as heard:
        while not jobs.draining.is_set():
            heard.clear()
            with suppress(StorageError):  # what the disk does not give now it may give later
                job, frames = await jobs.progress(job_id, ended, _AT_ONCE)
                if job is None:
                    return
                for frame in frames:
                    ended = frame.ended_as or ended
                    counts = {"frames_done": job.frames_done, "frames_failed": job.frames_failed,
                              "frames_total": job.frames_total}  # fmt: skip
                    yield _event("frame", frame_document(frame) | counts, str(ended))
                now = time.monotonic()
                changed = told is None or told.state != job.state or (told != job and now - told_at >= _PROGRESS_S)
                if changed:
                    yield _event("progress", job_document(job))
                    told, told_at = job, now
                if frames or changed:
                    sent_at = now
                if job.ended and len(frames) < _AT_ONCE:
                    yield _event("end", job_document(job), END)
                    return
                if len(frames) == _AT_ONCE:
                    continue
            if time.monotonic() - sent_at > _SILENCE_S:
                yield format_sse_event(comment="still here")
                sent_at = time.monotonic()
            with suppress(TimeoutError):
                await asyncio.wait_for(heard.wait(), _LOOK_S if told == job else _PROGRESS_S)


def _event(name: str, data: dict[str, Any], event_id: str | None = None) -> bytes:
    return format_sse_event(data_str=orjson.dumps(data).decode(), event=name, id=event_id)
