"""Keeps a farm's queues filled from the job store, and takes back what was lost anywhere."""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Final, ParamSpec, TypeVar

from conicoid_service.errors import BrokerError, StorageError
from conicoid_service.farm.broker import Broker
from conicoid_service.farm.queues import REDELIVERIES
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.records import PRIORITIES, Priority
from conicoid_service.jobs.storage import Storage
from conicoid_service.settings import Settings

P = ParamSpec("P")
T = TypeVar("T")

# Units of a priority that may wait in the broker. The store has the rest: so the broker stays small, and a new job of
# another owner does not wait for all that is there already.
WINDOW: Final = 2000
_AT_ONCE: Final = 100
_LOOK_S: Final = 1.0
# A worker renews what it renders every `executor.RENEW_S`, also while the store is slow.
SILENCE_MS: Final = 20_000
# Between a message's way to a worker and that worker's word of it; if the queue is empty meanwhile, it is lost.
UNHEARD_MS: Final = 10_000

logger = logging.getLogger(__name__)


class Steward:
    """For one event loop. Every API has one that sends; one at a time also takes back."""

    def __init__(self, settings: Settings, storage: Storage) -> None:
        self._storage, self._broker = storage, Broker(settings)
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="broker")
        self._more = asyncio.Event()
        self._draining = False
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

    async def stop(self) -> None:
        """Stop, between two steps."""
        if self._task:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        await asyncio.to_thread(self._thread.shutdown)
        self._broker.close()

    async def _run(self) -> None:
        while not self._draining:
            self._more.clear()
            try:
                if await self._storage.do(self._storage.leadership.leads):
                    await self._take_back()
                for priority in PRIORITIES:
                    await self._fill(priority)
            except (StorageError, BrokerError) as error:
                logger.warning("%s", error)
            except Exception:  # a defect must not leave all jobs waiting
                logger.exception("the steward met a defect")
            with suppress(TimeoutError):
                await asyncio.wait_for(self._more.wait(), _LOOK_S)

    async def _fill(self, priority: Priority) -> None:
        """Send units until the window is full or none waits."""
        outbox, urgency = self._storage.outbox, PRIORITIES[priority]
        room = WINDOW - await self._storage.do(outbox.out, urgency)
        while room > 0 and not self._draining:
            units = await self._storage.do(outbox.take, urgency, min(room, _AT_ONCE), now_ms())
            if not units:
                return
            room -= len(units)
            sent = await self._with_broker(self._broker.send, priority, units)
            if sent < len(units):
                await self._storage.insist(outbox.give_back, units[sent:])
                return

    async def _take_back(self) -> None:
        outbox = self._storage.outbox
        if silent := await self._storage.do(outbox.recall_running, now_ms() - SILENCE_MS):
            logger.warning("%d units of workers that have gone are sent again", silent)
        await self._bury()
        for priority, urgency in PRIORITIES.items():
            before = now_ms() - UNHEARD_MS
            if await self._with_broker(self._broker.depth, priority):
                continue
            if lost := await self._storage.do(outbox.recall_sent, urgency, before):
                logger.warning("%d units that the broker has lost are sent again", lost)

    async def _bury(self) -> None:
        """Let frames fail that have ended their workers; one that was only unlucky is sent again."""
        for unit, message in await self._with_broker(self._broker.dead):
            if unit is not None:
                detail = f"the frame was given to workers {REDELIVERIES + 1} times, and each time the worker ended"
                buried = await self._storage.do(
                    self._storage.outbox.bury, unit, "render-crashed", detail, REDELIVERIES + 1, now_ms()
                )
                logger.error("frame %d of job %s ends its workers: %s", unit.number, unit.job_id,
                             "it has failed" if buried else "it is sent again, or has ended")  # fmt: skip
            await self._with_broker(self._broker.forget, message)

    async def _with_broker(self, step: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Have the broker's thread take a step."""
        return await asyncio.wrap_future(self._thread.submit(step, *args, **kwargs))
