"""Quadrics that are kept between requests: resolved, in anonymous files, for any number of cameras.

They outlive the child processes, which get descriptors of the files; this process never looks into them.
"""

from dataclasses import dataclass

from conicoid.errors import LimitError
from conicoid_service.blob import Blob
from conicoid_service.errors import UnknownSceneError
from conicoid_service.recent import Recent


@dataclass(frozen=True)
class KeptScene:
    """Resolved quadrics.

    Attributes:
        id: their `conicoid.canonical.quadrics_hash`, so the same quadrics always have the same id.
        quadrics: how many they are.
        blob: `conicoid.scene.Quadrics`, see `conicoid.quadrics_file`.
    """

    id: str
    quadrics: int
    blob: Blob


class KeptScenes:
    """As many as a limit of bytes allows; whoever was not used for longest goes first. For one thread."""

    def __init__(self, limit: int) -> None:
        self._scenes: Recent[KeptScene] = Recent(limit)

    def keep(self, scene: KeptScene) -> None:
        """Take a scene over, in place of one with the same id.

        Raises:
            LimitError: it alone is larger than the limit; its file is closed, and the others stay.
        """
        size = len(scene.blob)
        if not self._scenes.put(scene.id, scene):
            raise LimitError("bytes of kept scenes", self._scenes.limit, size)

    def get(self, scene_id: str) -> KeptScene:
        """A kept scene, which now is the one that was used last; its file stays the store's.

        Raises:
            UnknownSceneError: it is not kept, or not any more.
        """
        scene = self._scenes.get(scene_id)
        if scene is None:
            raise UnknownSceneError(
                f"no scene is kept under {scene_id[:80]!r}, or not any more; keep it again with POST /v1/scenes"
            )
        return scene

    def drop(self, scene_id: str) -> None:
        """Give a scene up; requests that have its file already go on with it.

        Raises:
            UnknownSceneError: it is not kept.
        """
        self._scenes.drop(self.get(scene_id).id)

    def close(self) -> None:
        """Give all of them up."""
        self._scenes.close()
