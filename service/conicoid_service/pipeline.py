"""The way of a document through the two child processes.

The document process turns a body into a resolved scene, the render process turns a scene into an image. They are
two so that hostile text never costs the warm device process, and so that a document is refused, or answered as
already known, while a long render runs (`docs/decisions` has the measurements).
"""

import asyncio
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import partial

from conicoid_service.blob import Blob
from conicoid_service.bodies import Body
from conicoid_service.channel import Message
from conicoid_service.child import Kind
from conicoid_service.cpus import usable_cpus
from conicoid_service.images import Image
from conicoid_service.kept_scenes import Kept, KeptScene, KeptScenes
from conicoid_service.memory import usable_memory
from conicoid_service.pool import Pool
from conicoid_service.settings import Settings
from conicoid_service.task import Answer
from conicoid_service.telemetry import context

Timings = dict[str, float]


@dataclass(frozen=True)
class Commands:
    """How the child processes are started; tests put others in their place.

    -P: a file in the current directory must not shadow a module.
    """

    document: Sequence[str] = (sys.executable, "-P", "-m", "conicoid_service.document_process")
    render: Sequence[str] = (sys.executable, "-P", "-m", "conicoid_service.render_process")


@dataclass(frozen=True)
class ReadScene:
    """A document that has been read, for the render process.

    Attributes:
        view: camera and output, see `views`.
        quadrics: the quadrics, see `conicoid.quadrics_file`; whoever has finished with the two closes them.
        kept: whether the document only names them.
        scene_hash, quadrics_hash: as in `conicoid.canonical`.
        stored: whether the quadrics were on the disk, which may damage them.
    """

    view: Blob
    quadrics: Blob
    kept: bool
    scene_hash: str
    quadrics_hash: str
    timings: Timings = field(repr=False)
    stored: bool = False

    def shared(self) -> "ReadScene":
        """The same scene for another holder."""
        return replace(self, view=self.view.shared(), quadrics=self.quadrics.shared())


@dataclass(frozen=True)
class ReadBatch:
    """A document of one or many cameras that has been read.

    Attributes:
        views: of each frame camera, output and scene hash, a line of JSON.
        quadrics: the quadrics; whoever has finished with the two closes them.
        frames: how many there are.
    """

    views: Blob
    quadrics: Blob
    frames: int
    quadrics_hash: str
    timings: Timings = field(repr=False)


class Pipeline:
    """The children and what flows through them.

    Attributes:
        on_answer: called with every answer of a child and what it took.
    """

    def __init__(
        self, settings: Settings, commands: Commands | None = None, warm: Collection[str] = ("document", "render")
    ) -> None:
        """Describe both.

        Args:
            settings: what they are told.
            commands: other child processes, for tests of supervision: no setting leads here.
            warm: which of them `start` starts; another one is started by the first request that needs it.
        """
        commands = commands or Commands()
        self._limits = {
            "quadrics": settings.quadric_limit,
            "pixels": settings.pixel_limit,
            "bytes of arrays": settings.body_limit,
            "frames": settings.frame_limit,
            "pixels of a job": settings.job_pixel_limit,
        }
        pool = partial(Pool, queue_length=settings.queue_length, owner_queue_length=settings.owner_queue_length)
        deadlines = settings.deadline_s, settings.start_deadline_s
        self.kept = KeptScenes(settings.kept_limit)
        self._warm = warm
        self.on_answer: Callable[[context.Step, Message], None] = lambda *_: None
        self._documents = pool(Kind("document", commands.document, {}, *deadlines))
        renders = Kind("render", commands.render, _configuration(settings), *deadlines, settings.render_recycle_after)
        self._renders = pool(renders, processes=settings.render_processes)

    def start(self) -> None:
        """Start the children that are to be warm in the background, if they are not started already.

        They load what they need while the caller loads an HTTP server or client: nothing here needs one.
        """
        for name in self._warm:
            self.children[name].start()

    async def stop(self) -> None:
        """End both children and give up what is kept."""
        await asyncio.gather(asyncio.to_thread(self._documents.stop), asyncio.to_thread(self._renders.stop))
        self.kept.close()

    @property
    def children(self) -> Mapping[str, Pool]:
        """Both pools, by their names."""
        return {child.name: child for child in (self._documents, self._renders)}

    async def device(self) -> Message:
        """What the render process says about itself: `device`, as `conicoid.device` describes it, and `threads`."""
        return await self._renders.hello()

    async def canonical(self, body: Body) -> tuple[bytes, Timings]:
        """The canonical form of a document; takes the body over.

        Raises:
            UnknownSceneError: it names quadrics that are not kept.
            StorageError: the job store, where they are kept, does not give them; so in `read` and `read_batch`.
        """
        with body.blob.shared() as again:
            answer = await self._ask("canonical", body)
            if (scene_id := answer.message.get("scene")) is not None:
                kept = await self.kept.get(scene_id)
                async with self.kept.used(scene_id):
                    answer = await self._ask("canonical", replace(body, blob=again.shared()), kept.blob)
        with answer.blobs[0] as text:
            return text.read(), self._timings("document", answer)

    async def keep(self, body: Body) -> tuple[Kept, Timings]:
        """Keep the quadrics of a document; takes the body over.

        Raises:
            LimitError: they are more than may be kept.
            StorageError: the job store, where they are to be kept, does not take them.
        """
        answer = await self._ask("keep", body)
        scene = KeptScene(answer.message["quadrics_hash"], answer.message["quadrics"], answer.blobs[0])
        return await self.kept.keep(scene), self._timings("document", answer)

    async def read(self, body: Body, frame: int | None = None, band: str | None = None) -> ReadScene:
        """Read a document and check it against the limits; takes the body over, the caller closes what is read.

        Of which frame and band is as in `parts.Part.of`.

        Raises:
            ReportedError: `parameter`: there is no such frame or band.
            UnknownSceneError: it names quadrics that are not kept.
        """
        answer = await self._ask("read", body, frame=frame, band=band)
        view, quadrics, stored = await self._parts(answer)
        kept, hashes = "scene" in answer.message, (answer.message["scene_hash"], answer.message["quadrics_hash"])
        return ReadScene(view, quadrics, kept, *hashes, self._timings("document", answer), stored)

    async def read_batch(self, body: Body) -> ReadBatch:
        """Read a document with `camera` or `cameras`; otherwise as `read`."""
        answer = await self._ask("batch", body)
        views, quadrics, _ = await self._parts(answer)
        message = answer.message
        timings = self._timings("document", answer)
        return ReadBatch(views, quadrics, message["frames"], message["quadrics_hash"], timings)

    async def render(self, read: ReadScene, *, owner: str = "", batch: bool = False) -> tuple[Image, Timings]:
        """The EXR image of a scene. Takes the scene over; the caller closes the image.

        Raises:
            UnknownSceneError: the scene, which the document only names, was damaged where it was kept.
        """
        hashes = {"scene_hash": read.scene_hash, "quadrics_hash": read.quadrics_hash}
        message = {"do": "render", **hashes, "stored": read.stored, **context.ids()}
        async with self.kept.used(read.quadrics_hash) if read.kept else nullcontext():
            answer = await self._renders.call(message, [read.view, read.quadrics], owner=owner, batch=batch)
        escalated = answer.message["refined"], answer.message["settled"]
        return Image(answer.blobs[0], read.scene_hash, *escalated), self._timings("render", answer)

    async def join(
        self,
        view: Blob,
        bands: Sequence[Blob],
        scene_hash: str,
        quadrics_hash: str,
        *,
        escalated: tuple[int, int] = (0, 0),
        owner: str = "",
        batch: bool = False,
    ) -> tuple[Image, Timings]:
        """The EXR image of a frame from its bands, see `joining`. Takes the blobs over; the caller closes the image.

        The view and both hashes are the frame's own, the bands EXR files from the top; `escalated` is `refined` and
        `settled` of all bands together, which no file says.

        Raises:
            ReportedError: `bands`: they are damaged or not the frame's.
        """
        message = {"do": "join", "quadrics_hash": quadrics_hash, **context.ids()}
        answer = await self._renders.call(message, [view, *bands], owner=owner, batch=batch)
        return Image(answer.blobs[0], scene_hash, *escalated), self._timings("render", answer)

    async def _ask(self, do: str, body: Body, *kept: Blob, **part: int | str | None) -> Answer:
        message = {"do": do, "limits": self._limits, "boundary": body.boundary, **part}
        return await self._documents.call(message | context.ids(), [body.blob, *kept])

    async def _parts(self, answer: Answer) -> tuple[Blob, Blob, bool]:
        """What a document shows; its quadrics, which are own or kept ones that it names; if they were stored."""
        shown, *own = answer.blobs
        if own:
            return shown, own[0], False
        try:
            kept = await self.kept.get(answer.message["scene"])
        except BaseException:
            shown.close()
            raise
        return shown, kept.blob, kept.stored

    def _timings(self, process: str, answer: Answer) -> Timings:
        timings = {"queue": answer.queue_ms, **answer.message["timings_ms"]}
        step = context.Step(process, timings)
        context.notes().steps.append(step)
        self.on_answer(step, answer.message)
        return timings


def _configuration(settings: Settings) -> Message:
    """What each render process is told: its share of the CPUs and of the memory, unless the settings name them."""
    processes = settings.render_processes
    return {
        "device": settings.device,
        "threads": settings.threads or max(1, usable_cpus() // processes),
        "memory_limit": settings.render_memory_limit or usable_memory() * 3 // 4 // processes,
        "cache_dir": str(settings.cache_dir),
    }
