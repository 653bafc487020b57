"""What a request asks of a document: one of its frames, a band of that."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from conicoid_service.bands import band_crop, band_view
from conicoid_service.errors import ParameterError

if TYPE_CHECKING:  # the API process asks, and loads no NumPy
    from conicoid.document import Batch, Document
    from conicoid.scene import Camera, Output


@dataclass(frozen=True)
class Part:
    """One view.

    Attributes:
        frame: number of a frame, from 0; None where the document must have one camera.
        band: which band, from 0, of how many; None for the whole frame.
    """

    frame: int | None = None
    band: tuple[int, int] | None = None

    @classmethod
    def of(cls, frame: int | None, band: str | None) -> "Part":
        """The part that a query names; `band` as in `0/4`."""
        if band is None:
            return cls(frame)
        index, count = map(int, band.split("/"))
        return cls(frame, (index, count))


def read_document(text: bytes, arrays: dict[str, Any], part: Part, **limits: int) -> "Document | Batch":
    """The document, of which many cameras are allowed where a frame is named; the rest is as `conicoid.document`."""
    from conicoid.document import parse, parse_batch

    return parse(text, arrays, **limits) if part.frame is None else parse_batch(text, arrays, **limits)


def view_of(document: "Document | Batch", part: Part) -> "tuple[Camera, Output]":
    """The view that is asked of a document that was read for it.

    Raises:
        ParameterError: it has no such frame, or the frame no such band.
    """
    cameras, output = document.views()
    frame = part.frame or 0
    if frame >= len(cameras):
        raise ParameterError(f"frame: {frame} is not a frame of this scene; give one of 0 to {len(cameras) - 1}")
    camera = cameras[frame]
    if part.band is None:
        return camera, output
    (band, count), rows = part.band, camera.crop[3] - camera.crop[1]
    if not band < count <= rows:
        raise ParameterError(
            f"band: {band}/{count} is not one of at most {rows} bands, as many as the frame has rows; "
            "give I/N with I from 0 to N - 1"
        )
    return band_view(camera, output, band_crop(camera.crop, band, count))
