"""What is given up: jobs whose time is over, images that nobody needs and for which there is no room, stray files."""

from collections import Counter
from collections.abc import Sequence
from typing import Any, Final, Literal

from sqlalchemy import Connection, delete, exists, func, select, union, update

from conicoid_service.jobs.database import Database, upsert
from conicoid_service.jobs.records import STATES, UNFINISHED, StoredImage
from conicoid_service.jobs.tables import frames, images, jobs, scenes

Counted = Literal["jobs", "frames", "bytes"]

_AT_ONCE: Final = 100
_TOLERANCE_MS: Final = 60_000  # a write to the disk is saved for each use within it
_NEEDED: Final = exists().where(frames.c.tag == images.c.tag)


class Upkeep:
    """Jobs and images in a database, seen as what takes room."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def image(self, tag: str, now_ms: int) -> StoredImage | None:
        """What is known of an image, which now is the one that was used last, give or take a minute."""
        columns = [images.c[name] for name in StoredImage.__dataclass_fields__]
        this = images.c.tag == tag
        with self._database.reading() as connection:
            row = connection.execute(select(*columns, images.c.used_ms).where(this)).one_or_none()
        if row is None:
            return None
        if now_ms - row.used_ms > _TOLERANCE_MS:
            with self._database.writing() as connection:
                connection.execute(update(images).where(this).values(used_ms=now_ms))
        return StoredImage(*row[:-1])

    def remember(self, image: StoredImage, now_ms: int) -> None:
        """Note an image that is on the disk."""
        with self._database.writing() as connection:
            upsert(connection, images, {**image.__dict__, "used_ms": now_ms})

    def forget(self, tag: str) -> None:
        """An image is not on the disk any more, though it should be."""
        with self._database.writing() as connection:
            connection.execute(delete(images).where(images.c.tag == tag))

    def expire(self, now_ms: int) -> int:
        """Give up jobs whose time is over; how many they were."""
        with self._database.writing() as connection:
            return connection.execute(delete(jobs).where(jobs.c.expires_ms <= now_ms)).rowcount

    def evict(self, limit: int) -> list[str]:
        """The tags of some images to remove, forgotten already: of those that no job needs, used longest ago.

        Empty when the rest takes no more than `limit` bytes, or jobs need all of it.
        """
        tags: list[str] = []
        with self._database.reading() as connection:  # it looks at all images, while nobody should wait
            total = _bytes(connection)
            over = total - limit
            if over <= 0 or _bytes(connection, _NEEDED) >= total:  # a sum is soon had, a search in vain is not
                return tags
            query = select(images.c.tag, images.c.bytes).where(~_NEEDED).order_by(images.c.used_ms).limit(_AT_ONCE)
            for tag, size in connection.execute(query):
                if over <= 0:
                    break
                tags.append(tag)
                over -= size
        if not tags:
            return tags
        with self._database.writing() as connection:
            still = delete(images).where(images.c.tag.in_(tags), ~_NEEDED).returning(images.c.tag)
            forgotten = set(connection.execute(still).scalars())
        return [tag for tag in tags if tag in forgotten]

    def overdrawn(self, limit: int) -> int | None:
        """Bytes of images that jobs need, if they are more than a limit."""
        with self._database.reading() as connection:
            if _bytes(connection) <= limit:  # which costs a tenth of the other sum
                return None
            needed = _bytes(connection, _NEEDED)
            return needed if needed > limit else None

    def counts(self, what: Counted) -> dict[str, float]:
        """Jobs or frames by state, or, by "", bytes of all images."""
        with self._database.reading() as connection:
            if what == "bytes":
                return {"": float(_bytes(connection))}
            counted = _frames(connection) if what == "frames" else _jobs(connection)
            return dict.fromkeys(STATES, 0.0) | {name: float(count) for name, count in counted.items()}

    def unknown_tags(self, tags: Sequence[str]) -> set[str]:
        """Those of some tags that no image has."""
        with self._database.reading() as connection:
            return set(tags).difference(
                connection.execute(select(images.c.tag).where(images.c.tag.in_(tags))).scalars()
            )

    def needed_quadrics(self) -> set[str]:
        """The hashes of the quadrics of all jobs and scenes.

        Of jobs that have ended too: a damaged image can be rendered again for as long as it is needed.
        """
        query = union(select(jobs.c.quadrics_hash), select(scenes.c.id))
        with self._database.reading() as connection:
            return set(connection.execute(query).scalars())


def _jobs(connection: Connection) -> dict[str, int]:
    rows = connection.execute(select(jobs.c.state, func.count()).group_by(jobs.c.state))
    return {state: count for state, count in rows}  # noqa: C416  # a row is no pair to mypy


def _frames(connection: Connection) -> dict[str, int]:
    """By state, from what the jobs have counted: other frames wait, or run, or were cancelled with their job."""
    running = select(func.count()).where(frames.c.state == "running", frames.c.band == 0).scalar_subquery()
    done, failed = func.sum(jobs.c.frames_done), func.sum(jobs.c.frames_failed)
    query = select(jobs.c.state, func.sum(jobs.c.frames_total), done, failed, running).group_by(jobs.c.state)
    counts: Counter[str] = Counter()
    for state, total, succeeded, without, run in connection.execute(query):
        counts["succeeded"] += succeeded
        counts["failed"] += without
        counts["queued" if state in UNFINISHED else state] += total - succeeded - without
        counts["running"] = run
    counts["queued"] -= counts["running"]
    return counts


def _bytes(connection: Connection, *where: Any) -> int:
    return int(connection.execute(select(func.coalesce(func.sum(images.c.bytes), 0)).where(*where)).scalar_one())
