"""The data window of a frame that is cut to its hits."""

import numpy as np
from numpy.typing import NDArray

Window = tuple[int, int, int, int]


def tight_window(crop: Window, rows: NDArray[np.bool_], columns: NDArray[np.bool_]) -> Window:
    """The bounding box of the hits; the crop's top left pixel where nothing is hit.

    Args:
        crop: (x0, y0, x1, y1), half-open, pixels of the whole image.
        rows: (y1 - y0,), which rows of the crop have hits.
        columns: (x1 - x0,), which columns do.
    """
    (top, bottom), (left, right) = _span(rows), _span(columns)
    return crop[0] + left, crop[1] + top, crop[0] + right, crop[1] + bottom


def _span(hit: NDArray[np.bool_]) -> tuple[int, int]:
    places = np.flatnonzero(hit)
    return (int(places[0]), int(places[-1]) + 1) if len(places) else (0, 1)
