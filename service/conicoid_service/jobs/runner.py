"""Renders the frames of jobs: takes them from the store, one for each worker, and puts their images there."""

import asyncio
import logging
from collections import Counter
from contextlib import suppress
from typing import Final

from conicoid_service.errors import DEFECT, ServiceError, StorageError
from conicoid_service.jobs.bell import Bell
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.disk import RETRY_S, Disk
from conicoid_service.jobs.painter import Painter
from conicoid_service.jobs.records import Claim, StoredImage
from conicoid_service.jobs.work import MOST_ATTEMPTS
from conicoid_service.telemetry import context

LOOK_S: Final = 1.0  # for frames and cancellations that other servers put into the store
# Not the frame's doing.
_LATER: Final = frozenset(
    {"queue-full", "stopping", "render-unavailable", "not-ready", "device-missing", "kernel-build", "storage"}
)

logger = logging.getLogger(__name__)


class Runner:
    """Some workers; for one event loop.

    Attributes:
        ended: frames that ended here, by how.
    """

    def __init__(self, disk: Disk, painter: Painter, bell: Bell) -> None:
        self._disk, self._painter, self._bell = disk, painter, bell
        self._more = asyncio.Event()
        self._workers: list[asyncio.Task[None]] = []
        self._rendering: dict[asyncio.Task[StoredImage], Claim] = {}
        self._draining = False
        self.ended = Counter[str](succeeded=0, failed=0)

    def start(self, workers: int) -> None:
        """Start rendering, so many frames at a time."""
        self._workers = [asyncio.create_task(self._work()) for _ in range(workers)]

    def wake(self) -> None:
        """There are new frames."""
        self._more.set()

    def cancel(self, job_id: str) -> None:
        """Stop rendering frames of a job, which the store has as cancelled already."""
        for task, claim in self._rendering.items():
            if claim.job_id == job_id:
                task.cancel()

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
                claim = await self._disk.insist(self._disk.work.claim, now_ms())
                if claim is None:
                    with suppress(TimeoutError):
                        await asyncio.wait_for(self._more.wait(), LOOK_S)
                    continue
                await self._end(claim)
            except Exception:  # a defect must not end the rendering of all jobs
                logger.exception("a worker met a defect")
                await asyncio.sleep(RETRY_S)

    async def _end(self, claim: Claim) -> None:
        """Render a frame and tell the store how it ended."""
        work = self._disk.work
        context.job_id.set(claim.job_id)
        rendering = asyncio.create_task(self._painter.paint(claim, batch=True))
        self._rendering[rendering] = claim
        self._bell.ring(claim.job_id)
        try:
            await self._watch(rendering, claim)
            image = rendering.result()
        except asyncio.CancelledError:
            if not rendering.cancelled():  # this worker is stopped, not the job
                rendering.cancel()
                await asyncio.wait({rendering})
                with suppress(StorageError):  # then others find out that this server has gone
                    await self._disk.do(work.release, claim, not_before_ms=0, counts=False)
                raise
            return
        except ServiceError as error:
            await self._failed(claim, error)
        except Exception:
            logger.exception("a frame met a defect", extra=_about(claim))
            await self._fail(claim, "internal", DEFECT)
        else:
            await self._disk.insist(work.finish, claim, image, now_ms())
            self.ended["succeeded"] += 1
            logger.info("frame done", extra=_about(claim))
        finally:
            del self._rendering[rendering]
        self._bell.ring(claim.job_id)

    async def _watch(self, rendering: "asyncio.Task[StoredImage]", claim: Claim) -> None:
        """Wait for the end of a rendering, and end it when another server has cancelled the job."""
        while not (await asyncio.wait({rendering}, timeout=LOOK_S))[0]:
            with suppress(StorageError):
                if not await self._disk.do(self._disk.work.is_ours, claim):
                    rendering.cancel()

    async def _failed(self, claim: Claim, error: ServiceError) -> None:
        work, code = self._disk.work, error.code
        if code in _LATER:
            later = now_ms() + round((error.retry_after_s or RETRY_S) * 1e3)
            await self._disk.insist(work.release, claim, not_before_ms=later, counts=False)
        elif code == "render-crashed" and claim.attempts < MOST_ATTEMPTS:
            await self._disk.insist(work.release, claim, not_before_ms=now_ms(), counts=True)
        else:
            logger.warning("frame failed: %s", error, extra=_about(claim))
            await self._fail(claim, code, str(error))

    async def _fail(self, claim: Claim, code: str, detail: str) -> None:
        self.ended["failed"] += 1
        await self._disk.insist(self._disk.work.fail, claim, code, detail, now_ms())


def _about(claim: Claim) -> dict[str, object]:
    return {"job_id": claim.job_id, "frame": claim.number, "owner": claim.owner}
