"""Images that were rendered lately, for whoever asks for one of them again.

An image is found by its entity tag, which names its bytes. The tag is made of the scene, so a document has to be read
first; unless the same body, byte for byte, was read before.
"""

from collections import OrderedDict
from dataclasses import dataclass, replace
from typing import Final

from conicoid_service.blob import Blob
from conicoid_service.recent import Recent

MOST_BODIES: Final = 4096  # some 300 bytes each


@dataclass(frozen=True)
class Image:
    """An EXR file.

    Attributes:
        blob: its bytes.
        scene_hash: of the scene that it shows.
        refined, settled: pixels that double-double rounded, and that exact arithmetic settled.
    """

    blob: Blob
    scene_hash: str
    refined: int
    settled: int

    def shared(self) -> "Image":
        """The same image for another holder."""
        return replace(self, blob=self.blob.shared())


class Images:
    """As many as a limit of bytes allows; whoever was not asked for longest goes first. For one thread."""

    def __init__(self, limit: int) -> None:
        self._images: Recent[Image] = Recent(limit)
        self._tags: OrderedDict[str, str] = OrderedDict()

    def keep(self, tag: str, image: Image) -> None:
        """Remember an image, which stays the caller's; one that alone is larger than the limit is not kept."""
        self._images.put(tag, image.shared())

    def get(self, tag: str) -> Image | None:
        """The image that a tag names, if it is here; the caller closes it."""
        image = self._images.get(tag)
        return None if image is None else image.shared()

    def note(self, body: str, tag: str) -> None:
        """Remember of a body, by its digest, which image it asks for."""
        self._tags[body] = tag
        if len(self._tags) > MOST_BODIES:
            self._tags.popitem(last=False)

    def tag_of(self, body: str) -> str | None:
        """The tag of the image that a body asks for, if that body was read lately."""
        if body in self._tags:
            self._tags.move_to_end(body)
        return self._tags.get(body)

    @property
    def size(self) -> int:
        """Bytes of all of them."""
        return self._images.size

    def close(self) -> None:
        """Give all of them up."""
        self._images.close()
