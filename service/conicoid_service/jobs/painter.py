"""From a unit in the store to its image there."""

from dataclasses import replace

from conicoid.errors import QuadricsFileError
from conicoid_service.bands import band_crop, band_view
from conicoid_service.blob import Blob
from conicoid_service.entity_tags import entity_tag
from conicoid_service.errors import RenderCrashedError, ReportedError, ServiceError
from conicoid_service.gallery import Gallery
from conicoid_service.images import Image
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.records import Claim, StoredImage
from conicoid_service.jobs.storage import Storage
from conicoid_service.jobs.work import MOST_ATTEMPTS
from conicoid_service.pipeline import Pipeline, ReadScene


class Painter:
    """Renders frames and bands and joins these, unless their images are there."""

    def __init__(self, storage: Storage, pipeline: Pipeline, gallery: Gallery) -> None:
        self._storage, self._pipeline, self._gallery = storage, pipeline, gallery

    async def paint(self, claim: Claim, *, batch: bool) -> StoredImage:
        """The unit's image, in the store; the database is told by the caller.

        Raises:
            ServiceError: it cannot be rendered.
        """
        storage, device = self._storage, (await self._pipeline.device())["device"]
        view, scene_hash = _view(claim)
        tag = entity_tag(scene_hash, device)
        known = await storage.insist(storage.shelf.about, tag, now_ms())
        if known is not None:
            return known
        if claim.attempts > MOST_ATTEMPTS:
            raise RenderCrashedError(f"the frame was begun {MOST_ATTEMPTS} times, and each time what rendered it ended")
        image = await (self._join(claim, batch) if claim.bands and not claim.band
                       else self._render(claim, view, scene_hash, tag, batch))  # fmt: skip
        with image.blob:
            return await storage.insist(storage.shelf.put, tag, image)

    async def _render(self, claim: Claim, view: bytes, scene_hash: str, tag: str, batch: bool) -> Image:
        quadrics = await self._storage.do(self._storage.quadrics.open, claim.quadrics_hash)
        if quadrics is None:
            raise ServiceError("the quadrics of the job are not in the store any more; submit it again")
        read = ReadScene(Blob.of(view), quadrics, False, scene_hash, claim.quadrics_hash, {}, stored=True)
        with read.view, read.quadrics:
            try:
                return (await self._gallery.show(tag, read, owner=claim.owner, batch=batch)).image
            except ReportedError as error:
                if error.code == QuadricsFileError.code:  # so that they are written when the job is submitted again
                    await self._storage.do(self._storage.quadrics.remove, claim.quadrics_hash)
                raise

    async def _join(self, claim: Claim, batch: bool) -> Image:
        """The whole frame, of bands that are there; of one that is not any more, rendered once more."""
        bands: list[Image] = []
        try:
            tags = await self._storage.do(self._storage.work.bands, claim)
            for number, tag in enumerate(tags, start=1):
                bands.append(await self._band(replace(claim, band=number), tag, batch))
            joined, _ = await self._pipeline.join(
                Blob.of(claim.view.encode()),
                [band.blob.shared() for band in bands],
                claim.scene_hash,
                claim.quadrics_hash,
                escalated=(sum(band.refined for band in bands), sum(band.settled for band in bands)),
                owner=claim.owner,
                batch=batch,
            )
            return joined
        finally:
            for band in bands:
                band.blob.close()

    async def _band(self, claim: Claim, tag: str | None, batch: bool) -> Image:
        storage = self._storage
        image = None if tag is None else await storage.image(tag)
        if image is None:
            again = await self.paint(claim, batch=batch)
            await storage.do(storage.upkeep.remember, again, now_ms())
            image = await storage.image(again.tag)
        if image is None:
            raise ServiceError(f"band {claim.band} of the frame is damaged as soon as it is stored")
        return image


def _view(claim: Claim) -> tuple[bytes, str]:
    """The view of a unit, a line of JSON, and the hash of its scene."""
    if not claim.band:
        return claim.view.encode(), claim.scene_hash
    from conicoid.canonical import view_hash
    from conicoid_service.views import view_from, view_line  # these load NumPy, which whole frames do not need

    camera, output = view_from(claim.view.encode())
    camera, output = band_view(camera, output, band_crop(camera.crop, claim.band - 1, claim.bands))
    return view_line(claim.quadrics_hash, camera, output), view_hash(claim.quadrics_hash, camera, output)
