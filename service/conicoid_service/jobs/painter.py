"""From a frame in the store to its image on the disk."""

from conicoid_service.blob import Blob
from conicoid_service.entity_tags import entity_tag
from conicoid_service.errors import RenderCrashedError, ServiceError
from conicoid_service.gallery import Gallery
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.disk import Disk
from conicoid_service.jobs.records import Claim, StoredImage
from conicoid_service.jobs.work import MOST_ATTEMPTS
from conicoid_service.pipeline import Pipeline, ReadScene


class Painter:
    """Renders frames, unless their images are there."""

    def __init__(self, disk: Disk, pipeline: Pipeline, gallery: Gallery) -> None:
        self._disk, self._pipeline, self._gallery = disk, pipeline, gallery

    async def paint(self, claim: Claim, *, batch: bool) -> StoredImage:
        """The frame's image, on the disk; the database is told by the caller.

        Raises:
            ServiceError: it cannot be rendered.
        """
        disk, device = self._disk, (await self._pipeline.device())["device"]
        tag = entity_tag(claim.scene_hash, device)
        known = await disk.insist(disk.shelf.about, tag, now_ms())
        if known is not None:
            return known
        if claim.attempts > MOST_ATTEMPTS:
            raise RenderCrashedError(f"the frame was begun {MOST_ATTEMPTS} times, and each time what rendered it ended")
        read = await self._read(claim)
        with read.view, read.quadrics:
            shown = await self._gallery.show(tag, read, owner=claim.owner, batch=batch)
        with shown.image.blob:
            return await disk.insist(disk.shelf.put, tag, shown.image)

    async def _read(self, claim: Claim) -> ReadScene:
        quadrics = await self._disk.do(self._disk.quadrics.open, claim.quadrics_hash)
        if quadrics is None:
            raise ServiceError("the quadrics of the job are not on the disk any more; submit it again")
        view = Blob.of(claim.view.encode())
        return ReadScene(view, quadrics, True, claim.scene_hash, claim.quadrics_hash, {}, stored=True)
