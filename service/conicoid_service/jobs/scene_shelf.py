"""Kept scenes in the job store, as the HTTP application uses them."""

import re
from contextlib import suppress
from typing import Final

from conicoid_service.blob import Blob
from conicoid_service.errors import StorageError
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.scenes import Uses
from conicoid_service.jobs.storage import Storage
from conicoid_service.kept_scenes import Kept

_TOLERANCE_MS: Final = 60_000  # a write to the disk is saved for each use within it
_ID: Final = re.compile(r"[0-9a-f]{64}")


class SceneShelf:
    """`conicoid_service.kept_scenes.SceneShelf`: rows that say what is kept, and files of quadrics; for one event loop.

    The files are those that jobs of the same quadrics have, too. What neither needs any more is removed by
    `Storage.remove_quadrics`.
    """

    def __init__(self, storage: Storage) -> None:
        self._storage = storage
        self._uses: dict[str, int] = {}  # that the database does not know of

    async def put(self, about: Kept, blob: Blob) -> None:
        """Write the file, a damaged one too, and then the row."""
        await self._storage.do(self._put, about, blob, self._take_uses())

    async def find(self, scene_id: str) -> Kept | None:
        """One query, and now and then a write that says what was used."""
        found = await self._storage.do(self._storage.scenes.find, scene_id) if _ID.fullmatch(scene_id) else None
        if found is None:
            return None
        about, used_ms = found
        self._uses[scene_id] = now = now_ms()
        if now - used_ms > _TOLERANCE_MS:
            with suppress(StorageError):  # a full disk can be read
                await self._storage.do(self._storage.scenes.note, self._take_uses())
        return about

    async def open(self, scene_id: str) -> Blob | None:
        """The file."""
        return await self._storage.do(self._storage.quadrics.open, scene_id)

    async def drop(self, scene_id: str) -> None:
        """Delete the row; the file may be a job's."""
        await self._storage.do(self._storage.scenes.drop, scene_id)

    async def discard(self, scene_id: str) -> None:
        """Delete the row and remove the file, which would be of no use to a job either."""
        await self._storage.do(self._storage.scenes.drop, scene_id)
        await self._storage.do(self._storage.quadrics.remove, scene_id)

    def _put(self, about: Kept, blob: Blob, uses: Uses) -> None:
        self._storage.quadrics.write(about.id, blob)
        self._storage.scenes.put(about, uses, now_ms())

    def _take_uses(self) -> Uses:
        uses, self._uses = self._uses, {}
        return uses
