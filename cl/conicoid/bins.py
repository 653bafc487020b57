"""Which quadrics each tile looks at: lists by count, prefix sum and fill, each in depth order."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.memory import Queue
from conicoid.program import build

TILE: Final = 16


@dataclass(frozen=True)
class Bins:
    """Tiles of the crop, on the image's own grid of 16 x 16 pixels.

    Attributes:
        origin: column and row of the first tile in the whole image.
        columns, rows: how many tiles.
        end: (rows * columns,) int32, where each tile's list ends; it begins where the one before ends.
        entries: (end[-1],) int32, the slots.
    """

    origin: tuple[int, int]
    columns: int
    rows: int
    end: NDArray[np.int32]
    entries: NDArray[np.int32]

    def tile_of(self, x: Any, y: Any) -> Any:
        """The tile, counted row by row, of pixels of the whole image."""
        return (y // TILE - self.origin[1]) * self.columns + (x // TILE - self.origin[0])

    def slots(self, tile: int) -> NDArray[np.int32]:
        """The list of one tile, counted row by row."""
        return self.entries[self.end[tile - 1] if tile else 0 : self.end[tile]]


class Binning:
    """The binning kernels of one device."""

    def __init__(self, queue: Queue) -> None:
        self._queue = queue
        self._fill = build(queue.context, ["bins.cl"]).fill_tiles

    def run(self, box: NDArray[np.int32], crop: tuple[int, int, int, int]) -> Bins:
        """Lists the slots of every tile.

        Args:
            box: (m, 4) int32 pixel boxes inside the crop, half-open, in depth order.
            crop: (x0, y0, x1, y1) in pixels.
        """
        x0, y0 = crop[0] // TILE, crop[1] // TILE
        columns, rows = -(-crop[2] // TILE) - x0, -(-crop[3] // TILE) - y0
        tiles = box // TILE
        tiles[:, 2:] = -(-box[:, 2:] // TILE)
        tiles -= np.array([x0, y0, x0, y0], dtype=np.int32)
        # Corners of every box in a difference array; its double running sum counts the boxes over each tile.
        corners = np.zeros((rows + 1) * (columns + 1), dtype=np.int64)
        for x, y, sign in ((0, 1, 1), (2, 1, -1), (0, 3, -1), (2, 3, 1)):
            corners += sign * np.bincount(tiles[:, y] * (columns + 1) + tiles[:, x], minlength=len(corners))
        counts = corners.reshape(rows + 1, columns + 1).cumsum(0).cumsum(1)[:rows, :columns].ravel()
        end = np.cumsum(counts)
        place = (end - counts).astype(np.int32)
        entries = np.empty(int(end[-1]), dtype=np.int32)
        if len(box):
            row_start, slots = _by_row(tiles, rows)
            self._queue.run_grid(self._fill, (rows, 1), self._queue.read_only(row_start),
                                 self._queue.read_only(slots), self._queue.read_only(tiles), np.int32(columns),
                                 self._queue.in_place(place), self._queue.in_place(entries))  # fmt: skip
        return Bins((x0, y0), columns, rows, end.astype(np.int32), entries)


def _by_row(tiles: NDArray[np.int32], rows: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The slots that touch each row of tiles, in order: where each row begins, and all rows' slots."""
    heights = tiles[:, 3] - tiles[:, 1]
    slots = np.repeat(np.arange(len(tiles), dtype=np.int32), heights)
    first = np.cumsum(heights) - heights
    row = (np.arange(len(slots)) - np.repeat(first - tiles[:, 1], heights)).astype(np.uint16)
    starts = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=rows))]).astype(np.int32)
    # A stable sort of uint16 is a radix sort.
    return starts, slots[np.argsort(row, kind="stable")]
