"""Frames that are too large for one unit of work, cut into bands of whole rows; `joining` puts them together again."""

from dataclasses import replace
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # a cut is made where neither pixels nor cameras are
    from conicoid.scene import Camera, Output, Precision

Window = tuple[int, int, int, int]

# Whoever joins them gets all of them, and the view, in one message: see `channel.MAX_BLOBS`.
MOST_BANDS: Final = 128


def band_count(crop: Window, precision: "Precision", band_pixels: int) -> int:
    """How many bands a frame is cut into so that none has more than `band_pixels` pixels.

    They have more where one row does, or where that takes more than `MOST_BANDS`. Frames that are not `exact` stay
    whole: their pixels may depend on what else is in the window. `float32` casts in binary64 where it sees a quadric
    from over 128 times its extent (`conicoid.cast`), and set-up in binary64 takes another way for quadrics that the
    window cuts (`whole_ellipses` in kernels/simple_forms.h).
    """
    if precision != "exact":
        return 1
    x0, y0, x1, y1 = crop
    rows = max(band_pixels // (x1 - x0), 1)
    return min(-(-(y1 - y0) // rows), MOST_BANDS)


def band_crop(crop: Window, band: int, count: int) -> Window:
    """The window of band 0 <= `band` < `count`, from the top; `count` is at most the crop's rows."""
    x0, y0, x1, y1 = crop
    upper, lower = (y0 + (y1 - y0) * k // count for k in (band, band + 1))
    return x0, upper, x1, lower


def band_view(camera: "Camera", output: "Output", crop: Window) -> "tuple[Camera, Output]":
    """What the part `crop` of a frame is rendered with, so that joining finds everything that the frame's file needs.

    Always the whole window, and the mask where the frame is cut to its hits; normals that are rounded only once. Zip,
    whatever the frame has: of 17 million pixels of a protein in nine planes it makes 114 MB of 604 in a second more.
    """
    mask = ("A",) if output.data_window == "tight" and "A" not in output.channels else ()
    whole = replace(
        output, channels=(*output.channels, *mask), compression="zip", data_window="full", half_normals=False
    )
    return replace(camera, crop=crop), whole
