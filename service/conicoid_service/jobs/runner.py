"""Renders the frames of jobs here: takes them from the store, one for each worker, and puts their images there."""

import asyncio
import logging
from contextlib import suppress
from typing import Final

from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.executor import Executor
from conicoid_service.jobs.storage import RETRY_S, Storage

_LOOK_S: Final = 1.0  # for frames that other servers put into the store

logger = logging.getLogger(__name__)


class Runner:
    """Some workers; for one event loop."""

    def __init__(self, storage: Storage, executor: Executor, workers: int) -> None:
        """`start` has so many frames rendered at a time."""
        self._storage, self._executor, self._count = storage, executor, workers
        self._more = asyncio.Event()
        self._workers: list[asyncio.Task[None]] = []
        self._draining = False

    def start(self) -> None:
        """Start rendering."""
        self._workers = [asyncio.create_task(self._work()) for _ in range(self._count)]

    def wake(self) -> None:
        """There are new frames."""
        self._more.set()

    def drain(self) -> None:
        """Begin no more frames."""
        self._draining = True
        self._more.set()

    async def stop(self) -> None:
        """Stop rendering; frames that have begun are given back, to be taken up by the next server."""
        for worker in self._workers:
            worker.cancel()
        await asyncio.gather(*self._workers, return_exceptions=True)

    async def _work(self) -> None:
        while not self._draining:
            self._more.clear()
            try:
                claim = await self._storage.insist(self._storage.work.claim, now_ms())
                if claim is None:
                    with suppress(TimeoutError):
                        await asyncio.wait_for(self._more.wait(), _LOOK_S)
                    continue
                await self._executor.execute(claim)
            except Exception:  # a defect must not end the rendering of all jobs
                logger.exception("a worker met a defect")
                await asyncio.sleep(RETRY_S)
