"""What requests do to jobs: make, show, cancel them. Each step is one transaction."""

import secrets
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from itertools import islice
from typing import Any, Final

import orjson
from sqlalchemy import Connection, Select, and_, case, func, insert, select, update

from conicoid_service.bands import band_count
from conicoid_service.errors import IdempotencyKeyError, JobLimitError, UnknownJobError
from conicoid_service.jobs.database import Database, alone
from conicoid_service.jobs.records import UNFINISHED, Frame, Job, State
from conicoid_service.jobs.tables import frames, images, jobs
from conicoid_service.jobs.units import end_job

_ROWS: Final = 500  # frames written at a time
_JOB_COLUMNS: Final = [jobs.c[one.name] for one in fields(Job)]


@dataclass(frozen=True)
class NewJob:
    """What a request asks for.

    Attributes:
        views: of each frame camera, output and scene hash, a line of JSON.
        priority: see `records.PRIORITIES`.
        digest: of all that the job means, for `idempotency_key`.
    """

    owner: str
    quadrics_hash: str
    frames_total: int
    views: Iterable[bytes]
    digest: str
    idempotency_key: str | None
    priority: int = 0


class JobStore:
    """The jobs in a database.

    Args:
        lifetime_ms: how long a job is kept after its end.
        owner_frame_limit: how many frames that have not ended one owner may have.
        band_pixels: how many pixels are rendered at a time.
    """

    def __init__(self, database: Database, lifetime_ms: int, owner_frame_limit: int, band_pixels: int) -> None:
        self._database, self._band_pixels = database, band_pixels
        self._lifetime_ms, self._owner_frame_limit = lifetime_ms, owner_frame_limit

    def create(self, new: NewJob, now_ms: int) -> tuple[Job, bool]:
        """A new job, on the disk when this returns; or the job that the same request made before, and False.

        Raises:
            IdempotencyKeyError: another request of this owner used the key.
            JobLimitError: the owner would have too many frames that have not ended.
        """
        with self._database.writing() as connection:
            alone(connection, f"jobs of {new.owner}")
            if new.idempotency_key is not None and (known := _by_key(connection, new)):
                if known.digest != new.digest:
                    raise IdempotencyKeyError(
                        f"Idempotency-Key {new.idempotency_key!r} was used for job {known.id}, which asks for "
                        "something else; use a new key for a new job"
                    )
                return known, False
            self._check_limit(connection, new)
            job_id = f"{now_ms:012x}{secrets.token_hex(8)}"
            connection.execute(
                insert(jobs).values(
                    id=job_id,
                    owner=new.owner,
                    state="queued",
                    created_ms=now_ms,
                    frames_total=new.frames_total,
                    quadrics_hash=new.quadrics_hash,
                    idempotency_key=new.idempotency_key,
                    digest=new.digest,
                    priority=new.priority,
                )
            )
            rows = self._rows(job_id, new.views)
            while some := list(islice(rows, _ROWS)):
                connection.execute(insert(frames), some)
            return _job(connection, job_id), True

    def get(self, job_id: str, owner: str) -> Job:
        """One job.

        Raises:
            UnknownJobError: it is not there, not any more, or another owner's.
        """
        with self._database.reading() as connection:
            return _owned(connection, job_id, owner)

    def page(self, owner: str, limit: int, before: str | None, state: State | None) -> list[Job]:
        """Up to `limit` jobs of an owner, newest first, from the one made before job `before` on."""
        query = select(*_JOB_COLUMNS).where(jobs.c.owner == owner).order_by(jobs.c.id.desc()).limit(limit)
        if before is not None:
            query = query.where(jobs.c.id < before)
        if state is not None:
            query = query.where(jobs.c.state == state)
        with self._database.reading() as connection:
            return [Job(*row) for row in connection.execute(query)]

    def frames(self, job_id: str, first: int, limit: int) -> list[Frame]:
        """The frames `first` ... `first + limit - 1` of a job, as far as there are."""
        query = _frames(job_id).where(frames.c.number >= first).order_by(frames.c.number).limit(limit)
        with self._database.reading() as connection:
            return [Frame(*row) for row in connection.execute(query)]

    def progress(self, job_id: str, ended: int, limit: int) -> tuple[Job | None, list[Frame]]:
        """A job, None if it is not there any more, and up to `limit` frames that ended after the first `ended` did."""
        query = _frames(job_id).where(frames.c.ended_as > ended).order_by(frames.c.ended_as).limit(limit)
        with self._database.reading() as connection:
            row = connection.execute(select(*_JOB_COLUMNS).where(jobs.c.id == job_id)).one_or_none()
            return (Job(*row) if row else None), [Frame(*row) for row in connection.execute(query)]

    def cancel(self, job_id: str, owner: str, now_ms: int) -> tuple[Job, bool]:
        """The job, which is cancelled if it had not ended, and whether it had not.

        Raises:
            UnknownJobError: as in `get`.
        """
        with self._database.writing() as connection:
            job = _owned(connection, job_id, owner, locked=True)
            if job.ended:
                return job, False
            of_job = frames.c.job_id == job_id
            connection.execute(
                update(frames).where(of_job, frames.c.state.in_(UNFINISHED)).values(state="cancelled", holder=None)
            )
            end_job(connection, job_id, "cancelled", now_ms, self._lifetime_ms)
            return _job(connection, job_id), True

    def _rows(self, job_id: str, views: Iterable[bytes]) -> Iterator[dict[str, Any]]:
        """Rows of frames and their bands."""
        for number, line in enumerate(views):
            view = orjson.loads(line)
            bands = band_count(view["camera"]["crop"], view["output"]["precision"], self._band_pixels)
            bands = bands if bands > 1 else 0
            row = {"job_id": job_id, "number": number, "state": "queued", "view": line.decode(),
                   "scene_hash": view["scene_hash"], "bands": bands}  # fmt: skip
            yield {**row, "band": 0, "bands_left": bands}
            for band in range(1, bands + 1):
                yield {**row, "band": band, "bands_left": 0}

    def _check_limit(self, connection: Connection, new: NewJob) -> None:
        left = func.sum(jobs.c.frames_total - jobs.c.frames_done - jobs.c.frames_failed)
        of_owner = select(left).where(jobs.c.owner == new.owner, jobs.c.state.in_(UNFINISHED))
        waiting = connection.execute(of_owner).scalar_one() or 0
        if waiting + new.frames_total > self._owner_frame_limit:
            raise JobLimitError(
                f"{waiting} frames wait already and {new.frames_total} more would pass the limit of "
                f"{self._owner_frame_limit}; wait for some to end, or cancel them"
            )


def _frames(job_id: str) -> Select[Any]:
    begun = and_(frames.c.state == "queued", frames.c.bands_left < frames.c.bands)
    others = {"bytes": images.c.bytes, "state": case((begun, "running"), else_=frames.c.state)}
    columns: list[Any] = [others.get(one.name, frames.c.get(one.name)) for one in fields(Frame)]
    joined = frames.outerjoin(images, frames.c.tag == images.c.tag)
    return select(*columns).select_from(joined).where(frames.c.job_id == job_id, frames.c.band == 0)


def _job(connection: Connection, job_id: str) -> Job:
    return Job(*connection.execute(select(*_JOB_COLUMNS).where(jobs.c.id == job_id)).one())


def _owned(connection: Connection, job_id: str, owner: str, *, locked: bool = False) -> Job:
    query = select(*_JOB_COLUMNS).where(jobs.c.id == job_id, jobs.c.owner == owner)
    row = connection.execute(query.with_for_update() if locked else query).one_or_none()
    if row is None:
        raise UnknownJobError(f"there is no job {job_id[:40]!r}, or not any more; GET /v1/jobs lists those that are")
    return Job(*row)


def _by_key(connection: Connection, new: NewJob) -> Job | None:
    query = select(*_JOB_COLUMNS).where(jobs.c.owner == new.owner, jobs.c.idempotency_key == new.idempotency_key)
    row = connection.execute(query).one_or_none()
    return Job(*row) if row else None
