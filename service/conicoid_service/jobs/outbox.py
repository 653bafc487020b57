"""What a farm's API does to units: send them to the broker, send again what was lost, bury what ends its workers."""

from bisect import bisect_right
from dataclasses import astuple
from typing import Any, Final

from sqlalchemy import Connection, exists, func, select, tuple_, update

from conicoid_service.jobs.database import Database
from conicoid_service.jobs.records import UNFINISHED, Unit
from conicoid_service.jobs.tables import frames, jobs
from conicoid_service.jobs.units import at, end_unit, owners_who_wait, waiting_units

_NOT_SENT: Final = frames.c.sent_ms.is_(None)
_QUEUED: Final = (frames.c.state == "queued", frames.c.sent_ms.is_not(None))


class Outbox:
    """The units in a database, as those who send them see them. Each step is one transaction."""

    def __init__(self, database: Database, lifetime_ms: int) -> None:
        self._database, self._lifetime_ms = database, lifetime_ms
        self._last_owner = ""

    def out(self, priority: int) -> int:
        """How many units of a priority were sent and not taken."""
        query = select(func.count()).select_from(frames).join(jobs).where(*_QUEUED, jobs.c.priority == priority)
        with self._database.reading() as connection:
            return connection.execute(query).scalar_one()

    def take(self, priority: int, limit: int, now_ms: int) -> list[Unit]:
        """Up to `limit` units that wait, marked as sent. Owners take turns, from call to call."""
        more = (_NOT_SENT, jobs.c.priority == priority)
        units: list[Unit] = []
        with self._database.reading() as connection:
            if not owners_who_wait(connection, now_ms, *more):
                return units
        with self._database.writing() as connection:
            owners = owners_who_wait(connection, now_ms, *more)
            after = bisect_right(owners, self._last_owner)
            for left, owner in zip(range(len(owners), 0, -1), owners[after:] + owners[:after], strict=True):
                part = -(-(limit - len(units)) // left)
                if not part:
                    break
                units += waiting_units(connection, owner, now_ms, part, *more)
                self._last_owner = owner
            _mark(connection, units, now_ms)
        return units

    def give_back(self, units: list[Unit]) -> None:
        """Some units were not sent."""
        with self._database.writing() as connection:
            _mark(connection, units, None)

    def recall_running(self, silent_since_ms: int) -> int:
        """Have units sent again whose worker has not said for so long that it works on them; how many they are."""
        silent = update(frames).where(frames.c.state == "running", frames.c.taken_ms < silent_since_ms)
        with self._database.writing() as connection:
            return connection.execute(silent.values(state="queued", holder=None, sent_ms=None)).rowcount

    def newest_taken(self, priority: int) -> int | None:
        """When the newest of the units was sent that are being rendered; None if none is."""
        newest = select(func.max(frames.c.sent_ms)).join_from(frames, jobs)
        with self._database.reading() as connection:
            running = newest.where(frames.c.state == "running", jobs.c.priority == priority)
            found: int | None = connection.execute(running).scalar_one()
            return found

    def recall_sent(self, priority: int, sent_before_ms: int) -> int:
        """Have units sent again that were sent before a time and not taken; how many they are."""
        of_priority = exists().where(jobs.c.id == frames.c.job_id, jobs.c.priority == priority)
        lost = update(frames).where(*_QUEUED, frames.c.sent_ms < sent_before_ms, of_priority)
        with self._database.writing() as connection:
            return connection.execute(lost.values(sent_ms=None)).rowcount

    def bury(self, unit: Unit, code: str, detail: str, attempts: int, now_ms: int) -> bool:
        """The unit has no image and will have none, whoever holds it; False if it has ended already.

        False also if fewer attempts were begun: then it was not the unit's doing, and it is sent again.
        """
        failed = {"state": "failed", "error_code": code, "error_detail": detail}
        unfinished: list[Any] = [frames.c.state.in_(UNFINISHED)]
        with self._database.writing() as connection:
            spent = [*unfinished, frames.c.attempts >= attempts]
            if end_unit(connection, unit, spent, failed, now_ms, self._lifetime_ms):
                return True
            # One that is being rendered is left to its worker, or recalled when that is silent.
            connection.execute(update(frames).where(*at(unit), frames.c.state == "queued").values(sent_ms=None))
            return False


def _mark(connection: Connection, units: list[Unit], sent_ms: int | None) -> None:
    these = tuple_(frames.c.job_id, frames.c.number, frames.c.band).in_([astuple(unit) for unit in units])
    connection.execute(update(frames).where(these, frames.c.state == "queued").values(sent_ms=sent_ms))
