"""One way to an image: from memory, from the disk, from whoever is rendering it already, or rendered now."""

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, Literal, Protocol

from conicoid_service.images import Image, Images
from conicoid_service.pipeline import Pipeline, ReadScene, Timings

Source = Literal["memory", "store", "shared", "rendered"]


class Shelf(Protocol):
    """Where images are kept beyond this process' life."""

    async def stored(self, tag: str) -> Image | None:
        """The image that an entity tag names, which the caller closes; None if it is not there."""
        ...


@dataclass(frozen=True)
class Shown:
    """An image and where it comes from; the caller closes it.

    Attributes:
        timings: empty where this request did not render it.
    """

    image: Image
    source: Source
    timings: Timings


class Gallery:
    """Images by their entity tags; for one event loop."""

    def __init__(self, pipeline: Pipeline, images: Images) -> None:
        self._pipeline, self.images = pipeline, images
        self.shelf: Shelf | None = None
        self._rendering: dict[tuple[str, bool], _Rendering] = {}

    async def at_hand(self, tag: str) -> Shown | None:
        """The image if it needs no rendering."""
        if (image := self.images.get(tag)) is not None:
            return Shown(image, "memory", {})
        if self.shelf is not None and (image := await self.shelf.stored(tag)) is not None:
            return Shown(image, "store", {})
        return None

    async def show(self, tag: str, read: ReadScene, *, owner: str = "", batch: bool = False) -> Shown:
        """The image of a scene; two who ask for the same at once share one rendering, and each its failure.

        Interactive requests do not wait for one of a batch, which may itself wait behind them. The scene stays the
        caller's.

        Raises:
            ServiceError: as `Pipeline.render`.
        """
        key = (tag, batch)
        rendering = self._rendering.get(key)
        first = rendering is None
        if rendering is None:
            rendering = _Rendering(self._render(tag, read.shared(), owner, batch), partial(self._rendering.pop, key))
            self._rendering[key] = rendering
        image, timings = await rendering.result()
        return Shown(image, "rendered" if first else "shared", timings if first else {})

    async def _render(self, tag: str, read: ReadScene, owner: str, batch: bool) -> tuple[Image, Timings]:
        image, timings = await self._pipeline.render(read, owner=owner, batch=batch)
        if not batch:  # a batch would drive out what people look at
            self.images.keep(tag, image)
        return image, timings


class _Rendering:
    """One rendering and those who wait for it; it is given up when none is left.

    Args:
        work: gives the image.
        over: called once, when nobody may join any more.
    """

    def __init__(self, work: Coroutine[Any, Any, tuple[Image, Timings]], over: Callable[[], Any]) -> None:
        self._task: Final = asyncio.ensure_future(work)
        self._over = over
        self._waiting = 0

    async def result(self) -> tuple[Image, Timings]:
        """What it gives; the image is the caller's own."""
        self._waiting += 1
        try:
            image, timings = await asyncio.shield(self._task)
            return image.shared(), timings
        finally:
            self._waiting -= 1
            if not self._waiting:
                self._over()
                self._task.cancel()
                self._task.add_done_callback(_close)


def _close(task: "asyncio.Task[tuple[Image, Timings]]") -> None:
    if not task.cancelled() and task.exception() is None:
        task.result()[0].blob.close()
