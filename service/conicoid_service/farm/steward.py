"""Keeps a farm's queues filled from the job store, and takes back what was lost anywhere."""

import asyncio
import logging
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Final, ParamSpec, TypeVar

from conicoid_service.errors import BrokerError, StorageError
from conicoid_service.farm.broker import Broker
from conicoid_service.farm.queues import REDELIVERIES
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.leases import SILENCE_MS
from conicoid_service.jobs.records import PRIORITIES, Priority, Unit
from conicoid_service.jobs.storage import Storage
from conicoid_service.settings import Settings

P = ParamSpec("P")
T = TypeVar("T")

# Units of a priority that may wait in the broker. The store has the rest: so the broker stays small, and a new job of
# another owner does not wait for all that is there already.
WINDOW: Final = 2000
_AT_ONCE: Final = 100
_LOOK_S: Final = 1.0
_STOP_S: Final = 5.0

logger = logging.getLogger(__name__)


class Steward:
    """For one event loop. Every API has one that sends; one at a time also takes back."""

    def __init__(self, settings: Settings, storage: Storage) -> None:
        self._storage, self._broker = storage, Broker(settings)
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="broker")
        self._more = asyncio.Event()
        self._draining = False
        self._reached_since = time.monotonic()  # the database
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Start in the background."""
        self._task = asyncio.create_task(self._run())

    def wake(self) -> None:
        """There are new units."""
        self._more.set()

    def drain(self) -> None:
        """Send no more."""
        self._draining = True
        self._more.set()

    async def stop(self) -> None:
        """Stop once what was marked as sent is sent, or given back."""
        self.drain()
        if self._task and (await asyncio.wait({self._task}, timeout=_STOP_S))[1]:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        self._thread.shutdown(wait=False)
        self._broker.close()

    async def _run(self) -> None:
        while not self._draining:
            self._more.clear()
            try:
                await self._round()
            except StorageError as error:
                self._reached_since = time.monotonic()
                logger.warning("%s", error)
            except BrokerError as error:
                logger.warning("%s", error)
                await asyncio.to_thread(self._storage.leadership.resign)  # another may reach it
            except Exception:  # a defect must not leave all jobs waiting
                logger.exception("the steward met a defect")
            if not self._draining:
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._more.wait(), _LOOK_S)

    async def _round(self) -> None:
        await self._with_broker(self._broker.connect)
        if await self._storage.do(self._storage.leadership.leads):
            await self._take_back()
        for priority in PRIORITIES:
            await self._fill(priority)

    async def _fill(self, priority: Priority) -> None:
        """Send units until the window is full or none waits."""
        storage, urgency = self._storage, PRIORITIES[priority]
        room = WINDOW - await storage.do(storage.outbox.out, urgency)
        while room > 0 and not self._draining:
            units = await storage.do(storage.leases.send, urgency, min(room, _AT_ONCE))
            if not units:
                return
            room -= len(units)
            sent = 0
            try:
                sent = await self._with_broker(self._broker.send, priority, units)
            finally:
                if sent < len(units):
                    await storage.insist(storage.outbox.give_back, units[sent:])
            if sent < len(units):
                return

    async def _take_back(self) -> None:
        storage = self._storage
        # While the database was away, nobody could renew.
        could_renew = time.monotonic() - self._reached_since > SILENCE_MS / 1e3
        if could_renew and (silent := await storage.do(storage.leases.recall_silent)):
            logger.warning("%d units of workers that have gone are sent again", silent)
        await self._bury()
        for priority, urgency in PRIORITIES.items():
            is_empty = not await self._with_broker(self._broker.depth, priority)
            if lost := await storage.do(storage.leases.recall_lost, urgency, queue_is_empty=is_empty):
                logger.warning("%d units that were sent and not taken are sent again", lost)

    async def _bury(self) -> None:
        """Let frames fail that have ended their workers; one that was only unlucky is sent again."""
        while not self._draining and (dead := await self._with_broker(self._broker.dead)):
            unit, message = dead
            try:
                if unit is not None:
                    await self._bury_one(unit)
            except StorageError:
                await self._with_broker(self._broker.close)  # so that it comes back
                raise
            except Exception:  # a defect of one must not keep the others from their units
                logger.exception("a dead letter met a defect: %s", unit)
            await self._with_broker(self._broker.forget, message)

    async def _bury_one(self, unit: Unit) -> None:
        detail = f"the frame was given to workers {REDELIVERIES + 1} times, and each time the worker ended"
        buried = await self._storage.do(
            self._storage.outbox.bury, unit, "render-crashed", detail, REDELIVERIES + 1, now_ms()
        )
        outcome = "it has failed" if buried else "it is sent again, or has ended"
        logger.error("frame %d of job %s ends its workers: %s", unit.number, unit.job_id, outcome)

    async def _with_broker(self, step: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Have the broker's thread take a step."""
        return await asyncio.wrap_future(self._thread.submit(step, *args, **kwargs))
