"""Kept scenes in a database; `Storage.quadrics` has their files."""

from collections.abc import Mapping

from sqlalchemy import Connection, delete, func, select, update

from conicoid_service.jobs.database import Database, alone, upsert
from conicoid_service.jobs.tables import scenes
from conicoid_service.kept_scenes import Kept

Uses = Mapping[str, int]


class Scenes:
    """As many as a limit of bytes allows; whoever was not used for longest goes first.

    Args:
        limit: bytes of all of them.
    """

    def __init__(self, database: Database, limit: int) -> None:
        self._database, self._limit = database, limit

    def put(self, about: Kept, uses: Uses, now_ms: int) -> None:
        """Note a scene, the file of which is there, as the one that was used last; others go where it needs room.

        `uses` says when others were used that `note` has not been told of.
        """
        newest_first = (scenes.c.id != about.id, scenes.c.used_ms.desc(), scenes.c.id)
        so_far = func.sum(scenes.c.bytes).over(order_by=newest_first)
        sizes = select(scenes.c.id, so_far.label("bytes")).subquery()
        with self._database.writing() as connection:
            alone(connection, "scenes")
            _note(connection, uses)
            upsert(connection, scenes, {**about.__dict__, "used_ms": now_ms})
            too_many = select(sizes.c.id).where(sizes.c.bytes > self._limit)
            connection.execute(delete(scenes).where(scenes.c.id.in_(too_many)))

    def find(self, scene_id: str) -> tuple[Kept, int] | None:
        """A scene and when it was used last, as far as the database knows; None if it is not kept."""
        query = select(scenes.c.id, scenes.c.quadrics, scenes.c.bytes, scenes.c.used_ms).where(scenes.c.id == scene_id)
        with self._database.reading() as connection:
            row = connection.execute(query).one_or_none()
        return None if row is None else (Kept(*row[:-1]), row.used_ms)

    def note(self, uses: Uses) -> None:
        """Scenes were used at times."""
        with self._database.writing() as connection:
            alone(connection, "scenes")
            _note(connection, uses)

    def drop(self, scene_id: str) -> None:
        """Keep a scene no longer."""
        with self._database.writing() as connection:
            connection.execute(delete(scenes).where(scenes.c.id == scene_id))


def _note(connection: Connection, uses: Uses) -> None:
    for scene_id, used_ms in uses.items():
        earlier = scenes.c.id == scene_id, scenes.c.used_ms < used_ms
        connection.execute(update(scenes).where(*earlier).values(used_ms=used_ms))
