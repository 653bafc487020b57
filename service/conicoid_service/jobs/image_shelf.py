"""Images on the disk, by entity tag."""

import hashlib
import logging

from conicoid_service.blob import Blob
from conicoid_service.images import Image
from conicoid_service.jobs.folder import Folder
from conicoid_service.jobs.records import StoredImage
from conicoid_service.jobs.upkeep import Upkeep

logger = logging.getLogger(__name__)


def name_of(tag: str) -> str:
    """What an image is called in the store: its entity tag without the quotes."""
    return tag.strip('"')


def sha256_of(blob: Blob) -> str:
    """SHA-256 of a file, in hexadecimal."""
    digest = hashlib.sha256()
    for chunk in blob.chunks():
        digest.update(chunk)
    return digest.hexdigest()


class ImageShelf:
    """A folder of images and what the database knows of them; for one thread at a time."""

    def __init__(self, folder: Folder, upkeep: Upkeep) -> None:
        self._folder, self._upkeep = folder, upkeep

    def put(self, tag: str, image: Image) -> StoredImage:
        """Write an image to the disk, where it stays; the database is told by the caller.

        Raises:
            OSError: the disk does not take it.
        """
        name = name_of(tag)
        self._folder.write(name, image.blob)
        about = image.scene_hash, image.refined, image.settled
        return StoredImage(name, len(image.blob), sha256_of(image.blob), *about)

    def about(self, tag: str, now_ms: int) -> StoredImage | None:
        """What is known of an image that is there; None, and forgotten, if it is not as it was written."""
        found = self.get(tag, now_ms)
        if found is None:
            return None
        image, known = found
        image.blob.close()
        return known

    def get(self, tag: str, now_ms: int) -> tuple[Image, StoredImage] | None:
        """An image, which the caller closes; None, and forgotten, if it is missing or cut short."""
        known = self._upkeep.image(name_of(tag), now_ms)
        if known is None:
            return None
        blob = self._folder.open(known.tag)
        if blob is not None and len(blob) == known.bytes:
            return Image(blob, known.scene_hash, known.refined, known.settled), known
        if blob is not None:
            blob.close()
        self.forget(known)
        return None

    def forget(self, image: StoredImage) -> None:
        """An image is not as it was written: it will be rendered again."""
        logger.error("the stored image %s is damaged; it is rendered again when it is asked for", image.tag)
        self._upkeep.forget(image.tag)

    def make_room(self, limit: int) -> None:
        """Remove what no job needs until the rest takes `limit` bytes at most."""
        while tags := self._upkeep.evict(limit):
            for tag in tags:
                self._folder.remove(tag)

    def remove_strays(self, older_than_ms: int) -> None:
        """Remove files that the database does not know: their writers died before they could tell it."""
        known = self._upkeep.known_tags()
        for tag in list(self._folder.names(older_than_ms)):
            if tag not in known:
                self._folder.remove(tag)
