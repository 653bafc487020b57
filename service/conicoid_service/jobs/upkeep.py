"""What is given up: jobs whose time is over, images that nobody needs and for which there is no room, stray files."""

from collections.abc import Sequence
from typing import Any, Final, Literal

from sqlalchemy import Connection, delete, exists, func, select, union, update

from conicoid_service.jobs.database import Database, upsert
from conicoid_service.jobs.records import STATES, StoredImage
from conicoid_service.jobs.tables import frames, images, jobs, metadata, scenes

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
        with self._database.writing() as connection:
            over = _bytes(connection) - limit
            if over <= 0:
                return []
            query = select(images.c.tag, images.c.bytes).where(~_NEEDED).order_by(images.c.used_ms).limit(_AT_ONCE)
            tags: list[str] = []
            for tag, size in connection.execute(query):
                if over <= 0:
                    break
                tags.append(tag)
                over -= size
            connection.execute(delete(images).where(images.c.tag.in_(tags)))
            return tags

    def needed_bytes(self) -> int:
        """Bytes of images that jobs need."""
        with self._database.reading() as connection:
            return _bytes(connection, _NEEDED)

    def counts(self, what: Counted) -> dict[str, float]:
        """Jobs or frames by state, or, by "", bytes of all images."""
        with self._database.reading() as connection:
            if what == "bytes":
                return {"": float(_bytes(connection))}
            state = metadata.tables[what].c.state
            query = select(state, func.count()).group_by(state)
            rows = connection.execute(query.where(frames.c.band == 0) if what == "frames" else query)
            return dict.fromkeys(STATES, 0.0) | {name: float(count) for name, count in rows}

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


def _bytes(connection: Connection, *where: Any) -> int:
    return int(connection.execute(select(func.coalesce(func.sum(images.c.bytes), 0)).where(*where)).scalar_one())
