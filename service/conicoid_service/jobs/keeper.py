"""Keeps the store in order while the server runs."""

import asyncio
import logging
from typing import Final

from conicoid_service.errors import StorageError
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.holder import Holder
from conicoid_service.jobs.storage import Storage

RECLAIM_S: Final = 2.0
EVICT_S: Final = 10.0
SWEEP_S: Final = 3600.0  # it lists every file, which a store may charge for
# Files without an entry in the database may belong to a server that is about to make it.
_STRAY_MS: Final = 3_600_000

logger = logging.getLogger(__name__)


class Keeper:
    """Takes up what other servers left, ends what is over, makes room; for one event loop.

    Attributes:
        overdrawn: bytes of images that jobs need, if they were more than the limit some seconds ago.
    """

    def __init__(self, storage: Storage, store_limit: int) -> None:
        self._storage, self._store_limit = storage, store_limit
        self.overdrawn: int | None = None
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Start in the background."""
        self._task = asyncio.create_task(self._keep())

    async def stop(self) -> None:
        """Stop, between two steps."""
        if self._task:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    async def _keep(self) -> None:
        rounds = 0
        while True:
            try:
                if isinstance(self._storage.holder, Holder):  # else it is the steward's
                    await self._reclaim(self._storage.holder)
                if rounds % round(EVICT_S / RECLAIM_S) == 0:
                    leads = await self._storage.do(self._storage.leadership.leads)
                    if leads:
                        await self._storage.do(self._storage.check_mark)
                        await self._tidy()
                    self.overdrawn = await self._storage.do(self._storage.upkeep.overdrawn, self._store_limit)
                    await self._storage.do(self._storage.check)
                    if leads and rounds % round(SWEEP_S / RECLAIM_S) == 0:
                        await self._sweep()
            except StorageError as error:
                logger.warning("%s", error)
            except Exception:  # a defect here must not leave the store to itself
                logger.exception("the upkeep of the job store met a defect")
            await asyncio.sleep(RECLAIM_S)
            rounds += 1

    async def _reclaim(self, holder: Holder) -> None:
        """Give back the frames of servers that died."""
        storage = self._storage
        for name in await storage.do(storage.work.holders):
            if name != holder.name and not holder.lives(name):
                count = await storage.do(storage.work.take_from, name)
                logger.warning("%d frames of a server that ended are taken up again", count)

    async def _tidy(self) -> None:
        """End what is over and make room."""
        storage = self._storage
        await storage.do(storage.upkeep.expire, now_ms())
        # On a full disk images that nobody needs make room for those that somebody does.
        await storage.do(storage.shelf.make_room, 0 if storage.full else self._store_limit)

    async def _sweep(self) -> None:
        """Remove files that nothing leads to, which takes a look at all of them."""
        storage, older_than_ms = self._storage, now_ms() - _STRAY_MS
        await storage.do(storage.shelf.remove_strays, older_than_ms)
        await storage.do(storage.remove_quadrics, older_than_ms)
        for folder in (storage.images, storage.quadrics):
            await storage.do(folder.sweep, older_than_ms)
