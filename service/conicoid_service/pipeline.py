"""The way of a document through the two child processes.

The document process turns a body into a resolved scene, the render process turns a scene into an image. They are
two so that hostile text never costs the warm device process, and so that a document is refused, or answered as
already known, while a long render runs (`docs/decisions` has the measurements).
"""

import asyncio
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

from conicoid_service.blob import Blob
from conicoid_service.bodies import Body
from conicoid_service.channel import Message
from conicoid_service.errors import NotReadyError
from conicoid_service.settings import Settings
from conicoid_service.supervisor import Answer, Supervisor

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
    """A document that has been read: its scene for the render process and the scene's hash."""

    scene: Blob
    scene_hash: str
    timings: Timings = field(repr=False)


class Pipeline:
    """Both children and what flows through them."""

    def __init__(self, settings: Settings, commands: Commands) -> None:
        self._limits = {
            "quadrics": settings.quadric_limit,
            "pixels": settings.pixel_limit,
            "bytes of arrays": settings.body_limit,
        }
        supervised = partial(
            Supervisor,
            queue_length=settings.queue_length,
            deadline_s=settings.deadline_s,
            start_deadline_s=settings.start_deadline_s,
        )
        device = {"device": settings.device, "threads": settings.threads, "cache_dir": str(settings.cache_dir)}
        self._documents = supervised("document", commands.document, {})
        self._renders = supervised("render", commands.render, device)

    def start(self) -> None:
        """Start both children in the background."""
        self._documents.start()
        self._renders.start()

    async def stop(self) -> None:
        """End both children."""
        await asyncio.gather(asyncio.to_thread(self._documents.stop), asyncio.to_thread(self._renders.stop))

    def check_ready(self) -> None:
        """Return if both children are alive and warm.

        Raises:
            ServiceError: the reason why one is not.
        """
        for child in (self._documents, self._renders):
            if not child.ready:
                raise child.failure or NotReadyError(f"the {child.name} process is starting; requests wait for it")

    async def device(self) -> Message:
        """What the render process says about itself: `device`, as `conicoid.device` describes it, and `threads`."""
        return await self._renders.hello()

    async def canonical(self, body: Body) -> tuple[bytes, Timings]:
        """The canonical form of a document; takes the body over."""
        answer = await self._read("canonical", body)
        with answer.blobs[0] as text:
            return text.read(), _timings(answer)

    async def read(self, body: Body) -> ReadScene:
        """Read a document and check it against the limits; takes the body over, the caller closes the scene."""
        answer = await self._read("read", body)
        return ReadScene(answer.blobs[0], answer.message["scene_hash"], _timings(answer))

    async def _read(self, do: str, body: Body) -> Answer:
        message = {"do": do, "limits": self._limits, "boundary": body.boundary}
        return await self._documents.call(message, [body.blob])

    async def render(self, read: ReadScene) -> tuple[Blob, Timings, dict[str, int]]:
        """The EXR image of a scene, and how many pixels were `refined` in double-double and `settled` on the host.

        Takes the scene over; the caller closes the image.
        """
        answer = await self._renders.call({"scene_hash": read.scene_hash}, [read.scene])
        return answer.blobs[0], _timings(answer), {key: answer.message[key] for key in ("refined", "settled")}


def _timings(answer: Answer) -> Timings:
    return {"queue": answer.queue_ms, **answer.message["timings_ms"]}
