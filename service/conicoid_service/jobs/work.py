"""What a server does to units: take one, end it, give it back. Each step is one transaction."""

from dataclasses import fields, replace
from typing import Any, Final

from sqlalchemy import Connection, Select, and_, exists, func, or_, select, update

from conicoid_service.jobs.database import Database, upsert
from conicoid_service.jobs.records import Claim, StoredImage, Unit
from conicoid_service.jobs.tables import frames, images, jobs
from conicoid_service.jobs.units import at, end_unit, of_frame, owners_who_wait, waiting_units

# A frame that is taken so often and never ended is what ends servers.
MOST_ATTEMPTS: Final = 5


class Work:
    """The units in a database, for the server that renders them.

    Args:
        holder: this server's name in the store.
        lifetime_ms: how long a job is kept after its end.
    """

    def __init__(self, database: Database, holder: str, lifetime_ms: int) -> None:
        self._database, self._holder, self._lifetime_ms = database, holder, lifetime_ms
        self._last_owner = ""

    def claim(self, now_ms: int) -> Claim | None:
        """Take the first unit of the next owner, who take turns; None if there is nothing to render."""
        with self._database.reading() as connection:  # so that an idle server writes nothing
            if not owners_who_wait(connection, now_ms):
                return None
        with self._database.writing() as connection:
            owners = owners_who_wait(connection, now_ms)
            if not owners:
                return None
            owner = next((one for one in owners if one > self._last_owner), owners[0])
            self._last_owner = owner
            unit = waiting_units(connection, owner, now_ms, 1)[0]
            return self._take(connection, unit, [], now_ms)

    def take(self, unit: Unit, now_ms: int, *, lost_before_ms: int) -> Claim | None:
        """Take a unit that a broker delivered; None if it is not wanted any more, or somebody else renders it.

        Args:
            unit: the unit.
            now_ms: the time.
            lost_before_ms: whoever took it before that time, and has not said anything since, is gone.
        """
        gone = and_(frames.c.state == "running", frames.c.taken_ms < lost_before_ms)
        with self._database.writing() as connection:
            return self._take(connection, unit, [or_(frames.c.state == "queued", gone)], now_ms)

    def _take(self, connection: Connection, unit: Unit, where: list[Any], now_ms: int) -> Claim | None:
        seen = connection.execute(_claims(unit)).one_or_none()
        if seen is None:
            return None
        *about, state = seen
        this = [*at(unit), frames.c.bands_left == 0, *where]
        if state == "queued":  # once in a job's life; before the frame, as whoever ends or cancels it locks them
            started = {"state": "running", "started_ms": func.coalesce(jobs.c.started_ms, now_ms)}
            its_own = [jobs.c.id == unit.job_id, jobs.c.state == "queued", exists().where(*this)]
            connection.execute(update(jobs).where(*its_own).values(started))
        taken = {"state": "running", "holder": self._holder, "attempts": frames.c.attempts + 1, "taken_ms": now_ms}
        taking = update(frames).where(*this).values(taken).returning(frames.c.attempts)
        attempts = connection.execute(taking).scalar()
        return None if attempts is None else replace(Claim(*about), attempts=attempts)

    def frame(self, job_id: str, number: int) -> Claim:
        """A whole frame as a claim would give it, without taking it."""
        with self._database.reading() as connection:
            return Claim(*connection.execute(_claims(Unit(job_id, number, 0))).one()[:-1])

    def finish(self, claim: Claim, image: StoredImage, now_ms: int) -> bool:
        """The unit has an image, which is on the disk; False if it was cancelled or taken from us."""
        with self._database.writing() as connection:
            upsert(connection, images, {**image.__dict__, "used_ms": now_ms})
            done = {"state": "succeeded", "tag": image.tag}
            return end_unit(connection, claim, self._ours(claim), done, now_ms, self._lifetime_ms)

    def fail(self, claim: Claim, code: str, detail: str, now_ms: int) -> bool:
        """The unit has no image and will have none; False as in `finish`."""
        failed = {"state": "failed", "error_code": code, "error_detail": detail}
        with self._database.writing() as connection:
            return end_unit(connection, claim, self._ours(claim), failed, now_ms, self._lifetime_ms)

    def release(self, claim: Claim, *, not_before_ms: int, counts: bool) -> None:
        """Give a unit back to be taken again, at a time of which this attempt counts or not."""
        waiting = {"state": "queued", "holder": None, "sent_ms": None, "not_before_ms": not_before_ms,
                   "attempts": claim.attempts - (not counts)}  # fmt: skip
        with self._database.writing() as connection:
            connection.execute(update(frames).where(*self._ours(claim)).values(waiting))

    def is_ours(self, claim: Claim) -> bool:
        """Whether the unit is still to be rendered here: not cancelled, nor taken from us."""
        with self._database.reading() as connection:
            return connection.execute(select(frames.c.number).where(*self._ours(claim))).one_or_none() is not None

    def renew(self, claim: Claim, now_ms: int) -> None:
        """Say that the unit is still being rendered here."""
        with self._database.writing() as connection:
            connection.execute(update(frames).where(*self._ours(claim)).values(taken_ms=now_ms))

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

    def bands(self, claim: Claim) -> list[str]:
        """The tags of the bands of a frame, in order."""
        query = select(frames.c.tag).where(*of_frame(claim), frames.c.band > 0).order_by(frames.c.band)
        with self._database.reading() as connection:
            return list(connection.execute(query).scalars())

    def _ours(self, claim: Claim) -> list[Any]:
        return [*at(claim), frames.c.state == "running", frames.c.holder == self._holder]


def _claims(unit: Unit) -> Select[Any]:
    """A unit as a `Claim` has it, and the state of its job."""
    columns = [jobs.c[one.name] if one.name in ("owner", "quadrics_hash") else frames.c[one.name]
               for one in fields(Claim)]  # fmt: skip
    return select(*columns, jobs.c.state).join_from(frames, jobs).where(*at(unit))
