"""Units in the tables: which wait, whose they are, and what the end of one means for its frame and its job."""

from typing import Any

from sqlalchemy import Connection, case, exists, select, update

from conicoid_service.jobs.records import UNFINISHED, State, Unit
from conicoid_service.jobs.tables import frames, jobs


def at(unit: Unit) -> list[Any]:
    """The unit's row."""
    return [*of_frame(unit), frames.c.band == unit.band]


def of_frame(unit: Unit) -> list[Any]:
    """The rows of the unit's frame, its bands included."""
    return [frames.c.job_id == unit.job_id, frames.c.number == unit.number]


def owners_who_wait(connection: Connection, now_ms: int, *more: Any) -> list[str]:
    """Whose units wait, in order; `more` are conditions on jobs and units."""
    query = select(jobs.c.owner).where(*_with_waiting(now_ms, *more)).distinct().order_by(jobs.c.owner)
    return list(connection.execute(query).scalars())


def waiting_units(connection: Connection, owner: str, now_ms: int, limit: int, *more: Any) -> list[Unit]:
    """The first units of an owner that wait, of urgent and then of old jobs first, which nobody else takes now."""
    # Job by job: each query reads no more rows than it gives and those that are not to be had before them.
    urgent = select(jobs.c.id).where(jobs.c.owner == owner, *_with_waiting(now_ms, *more))
    units: list[Unit] = []
    for job_id in connection.execute(urgent.order_by(jobs.c.priority.desc(), jobs.c.id).limit(limit)).scalars():
        query = (
            select(frames.c.job_id, frames.c.number, frames.c.band)
            .join_from(frames, jobs)
            .where(frames.c.job_id == job_id, *_waiting(now_ms), *more)
            .order_by(frames.c.number, frames.c.band)
            .limit(limit - len(units))
            .with_for_update(of=frames, skip_locked=True)  # in PostgreSQL; in SQLite whoever writes is alone
        )
        units += [Unit(*row) for row in connection.execute(query)]
        if len(units) == limit:
            break
    return units


def end_unit(
    connection: Connection, unit: Unit, where: list[Any], values: dict[str, Any], now_ms: int, lifetime_ms: int
) -> bool:
    """Let a unit end, and its frame and its job where it was their last; False if it is not as `where` says."""
    job = select(jobs.c.frames_total, jobs.c.frames_done, jobs.c.frames_failed).where(jobs.c.id == unit.job_id)
    row = connection.execute(job.with_for_update()).one_or_none()  # whoever ends another unit of the job comes after us
    if row is None:
        return False
    total, done, failed = row
    succeeded = values["state"] == "succeeded"
    ended = {**values, "holder": None}
    if unit.band and not _update(connection, [*at(unit), *where], ended):
        return False
    if unit.band and succeeded:
        whole = [*of_frame(unit), frames.c.band == 0]
        return _update(connection, whole, {"bands_left": frames.c.bands_left - 1})
    done, failed = done + succeeded, failed + (not succeeded)
    whole = [*of_frame(unit), frames.c.band == 0, *([frames.c.state.in_(UNFINISHED)] if unit.band else where)]
    values = {**ended, "ended_as": done + failed}
    bands = connection.execute(update(frames).where(*whole).values(values).returning(frames.c.bands)).scalar()
    if bands is None:
        return False
    if bands:
        _give_up_bands(connection, unit)
    counted = {"frames_done": done, "frames_failed": failed}
    connection.execute(update(jobs).where(jobs.c.id == unit.job_id).values(counted))
    if done + failed == total:
        end_job(connection, unit.job_id, "failed" if failed else "succeeded", now_ms, lifetime_ms)
    return True


def end_job(connection: Connection, job_id: str, state: State, now_ms: int, lifetime_ms: int) -> None:
    """End a job."""
    ended = {"state": state, "finished_ms": now_ms, "expires_ms": now_ms + lifetime_ms}
    connection.execute(update(jobs).where(jobs.c.id == job_id).values(ended))


def _update(connection: Connection, where: list[Any], values: dict[str, Any]) -> bool:
    return connection.execute(update(frames).where(*where).values(values)).rowcount > 0


def _give_up_bands(connection: Connection, unit: Unit) -> None:
    """Bands of a frame that has ended: their images are not needed, and those not rendered will not be."""
    unfinished = frames.c.state.in_(UNFINISHED)
    state = case((unfinished, "cancelled"), else_=frames.c.state)
    _update(connection, [*of_frame(unit), frames.c.band > 0], {"tag": None, "state": state})


def _with_waiting(now_ms: int, *more: Any) -> list[Any]:
    """Jobs of which units wait; it looks at no more of each than there are before one that does."""
    return [jobs.c.state.in_(UNFINISHED), exists().where(frames.c.job_id == jobs.c.id, *_waiting(now_ms), *more)]


def _waiting(now_ms: int) -> list[Any]:
    return [frames.c.state == "queued", frames.c.not_before_ms <= now_ms, frames.c.bands_left == 0]
