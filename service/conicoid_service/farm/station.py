"""What a child of a worker renders with: the store, one render process, and a thread for their event loop."""

import asyncio
import logging
import threading
from collections.abc import Mapping
from typing import Any, Literal

from conicoid_service.entity_tags import ENGINE
from conicoid_service.errors import ServiceError, StoreError
from conicoid_service.farm.queues import unit_of
from conicoid_service.gallery import Gallery
from conicoid_service.images import Images
from conicoid_service.jobs.executor import Executor
from conicoid_service.jobs.near import Near
from conicoid_service.jobs.painter import Painter
from conicoid_service.jobs.storage import RETRY_S, Storage
from conicoid_service.pipeline import Commands, Pipeline
from conicoid_service.settings import Settings

Outcome = Literal["done", "dropped", "unable"]

logger = logging.getLogger(__name__)


class Station:
    """Made in the process that uses it, after any fork; for one unit at a time."""

    def __init__(self, settings: Settings, commands: Commands | None = None) -> None:
        """`commands` are as in `Pipeline`."""
        self._settings = settings
        self._loop = asyncio.new_event_loop()
        self._pipeline = Pipeline(settings, commands, warm=["render"])
        self._pipeline.start()
        self._busy = asyncio.Lock()
        self._storage: Storage | None = None
        self._near: Near | None = None
        self._executor: Executor | None = None
        self._thread = threading.Thread(target=self._loop.run_forever, name="station", daemon=True)
        self._thread.start()

    def execute(self, message: Mapping[str, Any], *, redelivered: bool) -> Outcome:
        """Render the unit of a message.

        Args:
            message: see `queues.message_of`.
            redelivered: whether the broker knows that whoever had it before is gone.
        Returns:
            `done`: it has ended, or was given back, and the store knows. `dropped`: nobody wants it, or another has
            it. `unable`: it was given back, and so would be every other.
        """
        return asyncio.run_coroutine_threadsafe(self._execute(message, redelivered), self._loop).result()

    def close(self) -> None:
        """End the render process, give back a unit that it has, and close the store."""
        asyncio.run_coroutine_threadsafe(self._close(), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _close(self) -> None:
        await self._pipeline.stop()
        async with self._busy:
            if self._storage is not None:
                await asyncio.to_thread(self._storage.close)
            if self._near is not None:
                self._near.close()

    async def _execute(self, message: Mapping[str, Any], redelivered: bool) -> Outcome:
        async with self._busy:
            return await self._render(message, redelivered)

    async def _render(self, message: Mapping[str, Any], redelivered: bool) -> Outcome:
        unit = unit_of(message)
        storage, executor = await self._open()
        if (obstacle := await self._obstacle(storage, message["engine"])) is not None:
            logger.error("a unit is given back: %s", obstacle)
            await storage.insist(storage.outbox.give_back, [unit])
            return "unable"
        claim = await storage.insist(storage.leases.take, unit, redelivered=redelivered)
        if claim is None:
            return "dropped"
        await executor.execute(claim)
        return "done"

    async def _obstacle(self, storage: Storage, engine: str) -> str | None:
        """Why nothing can be rendered here, whatever the unit."""
        if engine != ENGINE:
            return f"it is of another engine, {engine}; this is {ENGINE}"
        try:
            await self._pipeline.device()
        except ServiceError as error:
            return str(error)
        if not await storage.insist(storage.is_marked):
            return "the object store is not the one of the database; see CONICOID_OBJECT_STORE"
        return None

    async def _open(self) -> tuple[Storage, Executor]:
        """The store, opened when the first unit comes, however long that takes."""
        while self._storage is None or self._executor is None:
            try:
                self._storage = await asyncio.to_thread(Storage, self._settings, api=False)
            except StoreError as error:
                logger.warning("%s", error)
                await asyncio.sleep(RETRY_S)
                continue
            self._near = Near(self._storage.quadrics, self._settings.kept_limit)
            self._storage.quadrics = self._near
            gallery = Gallery(self._pipeline, Images(0))
            self._executor = Executor(self._storage, Painter(self._storage, self._pipeline, gallery))
        return self._storage, self._executor
