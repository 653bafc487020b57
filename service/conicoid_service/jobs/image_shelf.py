"""Images on the disk, by entity tag."""

import hashlib
import logging
from itertools import islice
from typing import Final

from conicoid_service.blob import Blob
from conicoid_service.images import Image
from conicoid_service.jobs.files import Files
from conicoid_service.jobs.records import StoredImage
from conicoid_service.jobs.upkeep import Upkeep

_AT_ONCE: Final = 1000

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
    """The files of images and what the database knows of them."""

    def __init__(self, files: Files, upkeep: Upkeep) -> None:
        self._files, self._upkeep = files, upkeep

    def put(self, tag: str, image: Image) -> StoredImage:
        """Write an image to the disk, where it stays; the database is told by the caller.

        Raises:
            OSError: the disk does not take it.
        """
        name = name_of(tag)
        self._files.write(name, image.blob)
        about = image.scene_hash, image.refined, image.settled
        return StoredImage(name, len(image.blob), sha256_of(image.blob), *about)

    def about(self, tag: str, now_ms: int) -> StoredImage | None:
        """What is known of an image that is there; None, and forgotten, if it is missing or cut short."""
        known = self._upkeep.image(name_of(tag), now_ms)
        if known is not None and self._files.size(known.tag) != known.bytes:
            self.forget(known)
            return None
        return known

    def get(self, tag: str, now_ms: int) -> tuple[Image, StoredImage] | None:
        """An image, which the caller closes; None, and forgotten, if it is missing or cut short."""
        known = self._upkeep.image(name_of(tag), now_ms)
        if known is None:
            return None
        blob = self._files.open(known.tag)
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
                self._files.remove(tag)

    def remove_strays(self, older_than_ms: int) -> None:
        """Remove files that the database does not know: their writers died before they could tell it."""
        tags = self._files.names(older_than_ms)
        while some := list(islice(tags, _AT_ONCE)):
            for tag in self._upkeep.unknown_tags(some):
                self._files.remove(tag)
