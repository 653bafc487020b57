"""Jobs as the HTTP application sees them."""

import asyncio
import hashlib
import logging
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from typing import Protocol

from conicoid_service.blob import Blob
from conicoid_service.bodies import Body
from conicoid_service.errors import FrameFailedError, FrameNotReadyError, StorageError
from conicoid_service.gallery import Gallery
from conicoid_service.images import Image
from conicoid_service.jobs.bell import Bell
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.executor import Executor
from conicoid_service.jobs.image_shelf import sha256_of
from conicoid_service.jobs.keeper import Keeper
from conicoid_service.jobs.painter import Painter
from conicoid_service.jobs.records import PRIORITIES, Frame, Job, Priority, State
from conicoid_service.jobs.runner import Runner
from conicoid_service.jobs.storage import Storage
from conicoid_service.jobs.store import NewJob
from conicoid_service.jobs.upkeep import Counted
from conicoid_service.pipeline import Pipeline, Timings
from conicoid_service.settings import Settings

logger = logging.getLogger(__name__)


class Jobs:
    """The job store with what works on it; for one event loop.

    Attributes:
        draining: set when the server is about to end: nobody should wait for anything any more.
    """

    def __init__(self, settings: Settings, storage: Storage, pipeline: Pipeline, gallery: Gallery) -> None:
        self._settings, self._storage, self._pipeline = settings, storage, pipeline
        self.bell = Bell()
        self.draining = asyncio.Event()
        self._painter = Painter(storage, pipeline, gallery)
        self._executor = Executor(storage, self._painter, self.bell.ring)
        self._hands = _hands(settings, storage, self._executor)
        self._keeper = Keeper(storage, settings.store_limit)

    def start(self) -> None:
        """Have rendered what is in the store."""
        self._hands.start()
        self._keeper.start()

    def drain(self) -> None:
        """Begin no more frames, and end the streams of events."""
        self.draining.set()
        self._hands.drain()
        self.bell.ring_all()

    async def stop(self) -> None:
        """Stop rendering and close the store."""
        self.drain()
        await self._hands.stop()
        await self._keeper.stop()
        await asyncio.to_thread(self._storage.close)

    async def check(self) -> None:
        """Raises StorageError if the disk does not take a small file."""
        await self._storage.do(self._storage.check)

    async def counts(self, what: Counted) -> dict[str, float]:
        """As `Upkeep.counts`."""
        return await self._storage.do(self._storage.upkeep.counts, what)

    @property
    def frames_ended(self) -> Counter[str]:
        """Frames that ended since the start, by how."""
        return self._executor.ended

    async def units_sent(self) -> dict[str, float]:
        """Units that a farm's broker has, or has lost, by priority."""
        outbox = self._storage.outbox
        if not self._settings.farm:
            return {}
        return {name: float(await self._storage.do(outbox.out, urgency)) for name, urgency in PRIORITIES.items()}

    async def submit(self, body: Body, owner: str, key: str | None, priority: Priority) -> tuple[Job, bool, Timings]:
        """A job for the frames of a document, on the disk then, and whether it is new; takes the body over.

        Raises:
            SceneError, LimitError: the document is wrong or asks for too much.
            StorageError: the disk is full.
            IdempotencyKeyError, JobLimitError: as `JobStore.create`.
        """
        storage = self._storage
        batch = await self._pipeline.read_batch(body)
        with batch.views, batch.quadrics:
            if (needed := self._keeper.overdrawn) is not None:
                raise StorageError(
                    f"the images of jobs that are kept take {needed} bytes, the limit is {self._settings.store_limit}; "
                    "try again when some have expired"
                )
            if not await storage.do(storage.quadrics.touch, batch.quadrics_hash):
                await storage.do(storage.quadrics.write, batch.quadrics_hash, batch.quadrics)
            digest = hashlib.sha256(f"{batch.quadrics_hash}\n{sha256_of(batch.views)}".encode()).hexdigest()
            new = NewJob(
                owner, batch.quadrics_hash, batch.frames, _lines(batch.views), digest, key, PRIORITIES[priority]
            )
            job, is_new = await storage.do(storage.jobs.create, new, now_ms())
        if is_new:
            logger.info("job accepted", extra={"job_id": job.id, "owner": owner, "frames": job.frames_total})
        self._hands.wake()
        return job, is_new, batch.timings

    async def job(self, job_id: str, owner: str) -> Job:
        """One job; UnknownJobError as in `JobStore.get`."""
        return await self._storage.do(self._storage.jobs.get, job_id, owner)

    async def page(self, owner: str, limit: int, before: str | None, state: State | None) -> list[Job]:
        """Jobs of an owner, newest first."""
        return await self._storage.do(self._storage.jobs.page, owner, limit, before, state)

    async def frames(self, job_id: str, first: int, limit: int) -> list[Frame]:
        """Some frames of a job, in order."""
        return await self._storage.do(self._storage.jobs.frames, job_id, first, limit)

    async def progress(self, job_id: str, ended: int, limit: int) -> tuple[Job | None, list[Frame]]:
        """A job, None if it is not there any more, and frames that ended after the first `ended` did."""
        return await self._storage.do(self._storage.jobs.progress, job_id, ended, limit)

    async def cancel(self, job_id: str, owner: str) -> tuple[Job, bool]:
        """The job, cancelled if it had not ended, and whether it had not."""
        job, did = await self._storage.do(self._storage.jobs.cancel, job_id, owner, now_ms())
        if did:
            self._executor.cancel(job_id)
            self.bell.ring(job_id)
            logger.info("job cancelled", extra={"job_id": job_id, "owner": owner})
        return job, did

    async def image(self, job: Job, number: int) -> tuple[str, Image]:
        """The entity tag and image of a frame, which the caller closes.

        Raises:
            FrameNotReadyError: it has none, or not yet.
            FrameFailedError: it will have none.
        """
        found = await self.frames(job.id, number, 1)
        if not found or found[0].number != number:
            raise FrameNotReadyError(f"job {job.id} has the frames 0 to {job.frames_total - 1}, not {number}")
        frame = found[0]
        if frame.state == "failed":
            raise FrameFailedError(f"frame {number} failed: {frame.error_detail} [{frame.error_code}]")
        if frame.tag is None:
            error = FrameNotReadyError(f"frame {number} is {frame.state}" + ("" if job.ended else "; try again later"))
            error.retry_after_s = None if job.ended else 1
            raise error
        tag = f'"{frame.tag}"'
        return tag, await self._storage.image(tag) or await self._again(job, frame)

    async def image_elsewhere(self, job: Job, number: int) -> tuple[str, str] | None:
        """The entity tag of a frame's image and a URL where it can be had; None if it is to be had from here."""
        seconds = self._settings.download_redirect_s
        if not seconds:
            return None
        found = await self.frames(job.id, number, 1)
        tag = found[0].tag if found and found[0].number == number else None
        if tag is None:
            return None
        storage = self._storage
        if await storage.do(storage.shelf.about, tag, now_ms()) is None:
            return None
        link = await storage.do(storage.images.link, tag, seconds)
        return None if link is None else (f'"{tag}"', link)

    async def stored(self, tag: str) -> Image | None:
        """The image that an entity tag names, which the caller closes; None if the disk has it not, or gives it not."""
        with suppress(StorageError):
            return await self._storage.image(tag)
        return None

    async def _again(self, job: Job, frame: Frame) -> Image:
        """The image of a frame whose file is damaged."""
        storage = self._storage
        again = await self._painter.paint(await storage.do(storage.work.frame, job.id, frame.number), batch=False)
        await storage.do(storage.upkeep.remember, again, now_ms())
        image = await self._storage.image(again.tag) if again.tag == frame.tag else None
        if image is None:
            raise FrameFailedError(
                f"the image of frame {frame.number} was damaged on the disk, and this version or device would make "
                "another; submit the job again"
            )
        return image


class _Hands(Protocol):
    """What has frames rendered: here, or by a farm."""

    def start(self) -> None: ...
    def wake(self) -> None: ...
    def drain(self) -> None: ...
    async def stop(self) -> None: ...


def _hands(settings: Settings, storage: Storage, executor: Executor) -> _Hands:
    if settings.farm:
        from conicoid_service.farm.steward import Steward  # its library is an extra

        return Steward(settings, storage)
    # One more than can render, so that one frame is stored while the next is rendered.
    return Runner(storage, executor, settings.render_processes + 1)


def _lines(views: Blob) -> Iterator[bytes]:
    """The lines of a text, piece by piece."""
    rest = b""
    for chunk in views.chunks():
        *lines, rest = (rest + chunk).split(b"\n")
        yield from lines
    if rest:
        yield rest
