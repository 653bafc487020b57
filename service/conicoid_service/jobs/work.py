"""What a server does to frames: take one, end it, give it back. Each step is one transaction."""

from typing import Any, Final

from sqlalchemy import Connection, exists, func, insert, select, update

from conicoid_service.jobs.database import Database
from conicoid_service.jobs.records import UNFINISHED, Claim, StoredImage
from conicoid_service.jobs.store import end
from conicoid_service.jobs.tables import frames, images, jobs

# A frame that is taken so often and never ended is what ends servers.
MOST_ATTEMPTS: Final = 5


class Work:
    """The frames in a database, for the server that renders them; for one thread at a time.

    Args:
        holder: this server's name in the store.
        lifetime_ms: how long a job is kept after its end.
    """

    def __init__(self, database: Database, holder: str, lifetime_ms: int) -> None:
        self._database, self._holder, self._lifetime_ms = database, holder, lifetime_ms
        self._last_owner = ""

    def claim(self, now_ms: int) -> Claim | None:
        """Take the first frame of the next owner, who take turns; None if there is nothing to render."""
        with self._database.reading() as connection:  # so that an idle server writes nothing
            if not _owners(connection, now_ms):
                return None
        with self._database.writing() as connection:
            owners = _owners(connection, now_ms)
            if not owners:
                return None
            owner = next((one for one in owners if one > self._last_owner), owners[0])
            claim = _first(connection, owner, now_ms)
            taken = {"state": "running", "holder": self._holder, "attempts": claim.attempts}
            connection.execute(update(frames).where(*_place(claim)).values(taken))
            started = {"state": "running", "started_ms": func.coalesce(jobs.c.started_ms, now_ms)}
            connection.execute(update(jobs).where(jobs.c.id == claim.job_id, jobs.c.state == "queued").values(started))
        self._last_owner = owner
        return claim

    def frame(self, job_id: str, number: int) -> Claim:
        """A frame as a claim would give it, without taking it."""
        columns = [frames.c.job_id, frames.c.number, jobs.c.owner, jobs.c.quadrics_hash, frames.c.view,
                   frames.c.scene_hash, frames.c.attempts]  # fmt: skip
        query = select(*columns).join_from(frames, jobs).where(frames.c.job_id == job_id, frames.c.number == number)
        with self._database.reading() as connection:
            return Claim(*connection.execute(query).one())

    def finish(self, claim: Claim, image: StoredImage, now_ms: int) -> bool:
        """The frame has an image, which is on the disk; False if the frame was cancelled or taken from us."""
        with self._database.writing() as connection:
            remember(connection, image, now_ms)
            return self._ended(connection, claim, {"state": "succeeded", "tag": image.tag}, now_ms)

    def fail(self, claim: Claim, code: str, detail: str, now_ms: int) -> bool:
        """The frame has no image and will have none; False as in `finish`."""
        with self._database.writing() as connection:
            failed = {"state": "failed", "error_code": code, "error_detail": detail}
            return self._ended(connection, claim, failed, now_ms)

    def release(self, claim: Claim, *, not_before_ms: int, counts: bool) -> None:
        """Give a frame back to be taken again, at a time of which this attempt counts or not."""
        waiting = {"state": "queued", "holder": None, "not_before_ms": not_before_ms,
                   "attempts": claim.attempts - (not counts)}  # fmt: skip
        with self._database.writing() as connection:
            connection.execute(update(frames).where(*self._ours(claim)).values(waiting))

    def is_ours(self, claim: Claim) -> bool:
        """Whether the frame is still to be rendered here: not cancelled, nor taken from us."""
        with self._database.reading() as connection:
            return connection.execute(select(frames.c.number).where(*self._ours(claim))).one_or_none() is not None

    def holders(self) -> set[str]:
        """The names of all servers that are rendering frames."""
        with self._database.reading() as connection:
            return set(
                connection.execute(select(frames.c.holder).where(frames.c.state == "running").distinct()).scalars()
            )

    def take_from(self, holder: str) -> int:
        """Give back the frames of a server that died; how many they were."""
        with self._database.writing() as connection:
            lost = update(frames).where(frames.c.state == "running", frames.c.holder == holder)
            return connection.execute(lost.values(state="queued", holder=None)).rowcount

    def _ours(self, claim: Claim) -> list[Any]:
        return [*_place(claim), frames.c.state == "running", frames.c.holder == self._holder]

    def _ended(self, connection: Connection, claim: Claim, values: dict[str, Any], now_ms: int) -> bool:
        job = select(jobs.c.frames_total, jobs.c.frames_done, jobs.c.frames_failed).where(jobs.c.id == claim.job_id)
        row = connection.execute(job).one_or_none()
        if row is None:
            return False
        total, done, failed = row
        done, failed = done + (values["state"] == "succeeded"), failed + (values["state"] == "failed")
        ended = {**values, "holder": None, "ended_as": done + failed}
        if not connection.execute(update(frames).where(*self._ours(claim)).values(ended)).rowcount:
            return False
        counted = {"frames_done": done, "frames_failed": failed}
        connection.execute(update(jobs).where(jobs.c.id == claim.job_id).values(counted))
        if done + failed == total:
            end(connection, claim.job_id, "failed" if failed else "succeeded", now_ms, self._lifetime_ms)
        return True


def remember(connection: Connection, image: StoredImage, now_ms: int) -> None:
    """Note an image that is on the disk; once more if it was written once more."""
    row = {**image.__dict__, "used_ms": now_ms}
    if not connection.execute(update(images).where(images.c.tag == image.tag).values(row)).rowcount:
        connection.execute(insert(images).values(row))


def _owners(connection: Connection, now_ms: int) -> list[str]:
    """Whose frames wait, in order."""
    query = select(jobs.c.owner).where(*_with_waiting(now_ms)).distinct().order_by(jobs.c.owner)
    return list(connection.execute(query).scalars())


def _first(connection: Connection, owner: str, now_ms: int) -> Claim:
    """The first waiting frame of an owner who has one, as it will be when it is taken."""
    job = select(jobs.c.id, jobs.c.quadrics_hash).where(jobs.c.owner == owner, *_with_waiting(now_ms))
    job_id, quadrics_hash = connection.execute(job.order_by(jobs.c.id).limit(1)).one()
    frame = (
        select(frames.c.number, frames.c.view, frames.c.scene_hash, frames.c.attempts + 1)
        .where(frames.c.job_id == job_id, *_waiting(now_ms))
        .order_by(frames.c.number)
        .limit(1)
    )
    number, view, scene_hash, attempts = connection.execute(frame).one()
    return Claim(job_id, number, owner, quadrics_hash, view, scene_hash, attempts)


def _with_waiting(now_ms: int) -> list[Any]:
    """Jobs of which frames wait; it looks at no more than one of each."""
    return [jobs.c.state.in_(UNFINISHED), exists().where(frames.c.job_id == jobs.c.id, *_waiting(now_ms))]


def _waiting(now_ms: int) -> list[Any]:
    return [frames.c.state == "queued", frames.c.not_before_ms <= now_ms]


def _place(claim: Claim) -> list[Any]:
    return [frames.c.job_id == claim.job_id, frames.c.number == claim.number]
