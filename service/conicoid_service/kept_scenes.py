"""Quadrics that are kept between requests, resolved, for any number of cameras.

They are in files that outlive the child processes, which get descriptors of them; this process never looks into them.
Where there is a job store they are kept there, for all its servers and beyond their lives, and here is a copy of those
that were used lately.
"""

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from typing import Protocol

from conicoid.errors import LimitError, QuadricsFileError
from conicoid_service.blob import Blob
from conicoid_service.errors import ReportedError, StorageError, UnknownSceneError
from conicoid_service.recent import Recent

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Kept:
    """What is known of resolved quadrics.

    Attributes:
        id: their `conicoid.canonical.quadrics_hash`, so the same quadrics always have the same id.
        quadrics: how many they are.
        bytes: of their file.
    """

    id: str
    quadrics: int
    bytes: int


@dataclass(frozen=True)
class KeptScene:
    """Resolved quadrics.

    Attributes:
        id: as in `Kept`.
        quadrics: as in `Kept`.
        blob: `conicoid.scene.Quadrics`, see `conicoid.quadrics_file`.
        stored: whether it comes from the job store, whose disk may have damaged it.
    """

    id: str
    quadrics: int
    blob: Blob
    stored: bool = False

    @property
    def about(self) -> Kept:
        """What is known of it."""
        return Kept(self.id, self.quadrics, len(self.blob))

    def shared(self) -> "KeptScene":
        """The same scene for another holder."""
        return replace(self, blob=self.blob.shared())


class SceneShelf(Protocol):
    """Where scenes are kept beyond this process' life; every call raises StorageError while that is refused."""

    async def put(self, about: Kept, blob: Blob) -> None:
        """Keep a scene, in place of one with the same id; others may have to go for it. The blob stays the caller's."""
        ...

    async def find(self, scene_id: str) -> Kept | None:
        """A scene that is kept, which now is the one that was used last; None if there is none."""
        ...

    async def open(self, scene_id: str) -> Blob | None:
        """The quadrics of one that is kept, which the caller closes; None if they are lost."""
        ...

    async def drop(self, scene_id: str) -> None:
        """Keep a scene no longer."""
        ...

    async def discard(self, scene_id: str) -> None:
        """Keep a scene no longer, of which the file is damaged or lost."""
        ...


class KeptScenes:
    """As many as a limit of bytes allows; whoever was not used for longest goes first. For one event loop.

    Attributes:
        shelf: what says which scenes are kept; None if they are nowhere but here.
    """

    def __init__(self, limit: int) -> None:
        self._here: Recent[KeptScene] = Recent(limit)
        self._fetching = asyncio.Lock()
        self.shelf: SceneShelf | None = None

    async def keep(self, scene: KeptScene) -> Kept:
        """Take a scene over, in place of one with the same id.

        Raises:
            LimitError: it alone is larger than the limit; its file is closed, and the others stay.
            StorageError: the job store does not take it; its file is closed.
        """
        about = scene.about
        if about.bytes > self._here.limit:
            scene.blob.close()
            raise LimitError("bytes of kept scenes", self._here.limit, about.bytes)
        if self.shelf is not None:
            try:
                await self.shelf.put(about, scene.blob)
            except BaseException:
                scene.blob.close()
                raise
        self._here.put(scene.id, scene)
        return about

    async def about(self, scene_id: str) -> Kept:
        """What is known of a kept scene, which now is the one that was used last.

        Raises:
            UnknownSceneError: it is not kept, or not any more.
            StorageError: the job store cannot be asked.
        """
        if self.shelf is not None:
            about = await self.shelf.find(scene_id)
            if about is None:
                self._here.drop(scene_id)
        else:
            scene = self._here.get(scene_id)
            about = None if scene is None else scene.about
        if about is None:
            raise _unknown(scene_id)
        return about

    async def get(self, scene_id: str) -> KeptScene:
        """A kept scene, which now is the one that was used last; the caller closes its file.

        One that is here is given also while the job store cannot be asked.

        Raises:
            UnknownSceneError: it is not kept, or not any more.
            StorageError: the job store cannot be asked, or does not give it.
        """
        try:
            about = await self.about(scene_id)
        except StorageError:
            if (here := self._here.get(scene_id)) is None:
                raise
            return here.shared()
        if (here := self._here.get(scene_id)) is not None:
            return here.shared()
        async with self._fetching:  # what many ask for at once is fetched once
            if (here := self._here.get(scene_id)) is not None:
                return here.shared()
            return await self._fetch(about)

    async def drop(self, scene_id: str) -> None:
        """Give a scene up; requests that have its file already go on with it.

        Raises:
            UnknownSceneError, StorageError: as `about`.
        """
        await self.about(scene_id)
        self._here.drop(scene_id)
        if self.shelf is not None:
            await self.shelf.drop(scene_id)

    @asynccontextmanager
    async def used(self, scene_id: str) -> AsyncIterator[None]:
        """While a child process reads a scene, which is given up if that finds it damaged.

        Raises:
            UnknownSceneError: it was damaged.
        """
        try:
            yield
        except ReportedError as error:
            if error.code != QuadricsFileError.code:
                raise
            await self._give_up(scene_id, "damaged")
            raise UnknownSceneError(
                f"the scene {scene_id} was damaged in the job store; keep it again with POST /v1/scenes"
            ) from error

    def close(self) -> None:
        """Give all up that is here."""
        self._here.close()

    async def _fetch(self, about: Kept) -> KeptScene:
        blob = None if self.shelf is None else await self.shelf.open(about.id)
        if blob is None:
            await self._give_up(about.id, "lost")
            raise _unknown(about.id)
        scene = KeptScene(about.id, about.quadrics, blob, stored=True)
        self._here.put(about.id, scene.shared())
        return scene

    async def _give_up(self, scene_id: str, what: str) -> None:
        logger.error("the kept scene %s was %s in the job store, and is given up", scene_id, what)
        self._here.drop(scene_id)
        if self.shelf is not None:
            await self.shelf.discard(scene_id)


def _unknown(scene_id: str) -> UnknownSceneError:
    return UnknownSceneError(
        f"no scene is kept under {scene_id[:80]!r}, or not any more; keep it again with POST /v1/scenes"
    )
