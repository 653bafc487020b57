"""Renders units that were taken, and tells the store how they ended."""

import asyncio
import logging
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from conicoid_service.errors import DEFECT, ServiceError, StorageError
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.painter import Painter
from conicoid_service.jobs.records import Claim, StoredImage
from conicoid_service.jobs.storage import RETRY_S, Storage
from conicoid_service.jobs.work import MOST_ATTEMPTS
from conicoid_service.telemetry import context

LOOK_S: Final = 1.0  # for cancellations that others put into the store
RENEW_S: Final = 5.0
# Not the frame's doing.
_LATER: Final = frozenset(
    {"queue-full", "stopping", "render-unavailable", "not-ready", "device-missing", "kernel-build", "storage"}
)

logger = logging.getLogger(__name__)


class Executor:
    """For one event loop.

    Args:
        storage, painter: where units are and what makes images of them.
        changed: called with a job's id when something of it has changed.

    Attributes:
        ended: frames that ended here, by how.
    """

    def __init__(self, storage: Storage, painter: Painter, changed: Callable[[str], None] = lambda _: None) -> None:
        self._storage, self._painter, self._changed = storage, painter, changed
        self._rendering: dict[asyncio.Task[StoredImage], Claim] = {}
        self.ended = Counter[str](succeeded=0, failed=0)

    def cancel(self, job_id: str) -> None:
        """Stop rendering units of a job, which the store has as cancelled already."""
        for task, claim in self._rendering.items():
            if claim.job_id == job_id:
                task.cancel()

    async def execute(self, claim: Claim) -> None:
        """Render a unit and tell the store how it ended; if this is cancelled, the unit is given back."""
        work = self._storage.work
        context.job_id.set(claim.job_id)
        rendering = asyncio.create_task(self._painter.paint(claim, batch=True))
        self._rendering[rendering] = claim
        self._changed(claim.job_id)
        try:
            await self._watch(rendering, claim)
            image = rendering.result()
        except asyncio.CancelledError:
            if not rendering.cancelled():  # whoever renders is stopped, not the job
                rendering.cancel()
                await asyncio.wait({rendering})
                with suppress(StorageError):  # then others find out that this server has gone
                    await self._storage.do(work.release, claim, not_before_ms=0, counts=False)
                raise
            return
        except ServiceError as error:
            await self._failed(claim, error)
        except Exception:
            logger.exception("a frame met a defect", extra=_about(claim))
            await self._fail(claim, "internal", DEFECT)
        else:
            if await self._storage.insist(work.finish, claim, image, now_ms()):
                self.ended["succeeded"] += 1
                logger.info("frame done", extra=_about(claim))
        finally:
            del self._rendering[rendering]
        self._changed(claim.job_id)

    async def _watch(self, rendering: "asyncio.Task[StoredImage]", claim: Claim) -> None:
        """Wait for the end of a rendering, say that it goes on, and end it when the job was cancelled elsewhere."""
        rounds = 0
        while not (await asyncio.wait({rendering}, timeout=LOOK_S))[0]:
            rounds += 1
            with suppress(StorageError):
                if not await self._storage.do(self._storage.work.is_ours, claim):
                    rendering.cancel()
                elif self._storage.shared and rounds % round(RENEW_S / LOOK_S) == 0:
                    await self._storage.do(self._storage.leases.renew, claim)

    async def _failed(self, claim: Claim, error: ServiceError) -> None:
        work, code = self._storage.work, error.code
        if code in _LATER:
            later = self._storage.now_ms() + round((error.retry_after_s or RETRY_S) * 1e3)
            await self._storage.insist(work.release, claim, not_before_ms=later, counts=False)
        elif code == "render-crashed" and claim.attempts < MOST_ATTEMPTS:
            await self._storage.insist(work.release, claim, not_before_ms=0, counts=True)
        else:
            logger.warning("frame failed: %s", error, extra=_about(claim))
            await self._fail(claim, code, str(error))

    async def _fail(self, claim: Claim, code: str, detail: str) -> None:
        if await self._storage.insist(self._storage.work.fail, claim, code, detail, now_ms()):
            self.ended["failed"] += 1


def _about(claim: Claim) -> dict[str, object]:
    band = {"band": claim.band} if claim.band else {}
    return {"job_id": claim.job_id, "frame": claim.number, **band, "owner": claim.owner}
