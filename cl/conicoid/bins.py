"""Which quadrics each tile looks at: lists by count, prefix sum and fill, each in depth order."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.memory import Queue
from conicoid.program import build

TILE: Final = 16
# 512 MB; frames that need more are rendered in bands.
MOST_ENTRIES: Final = 2**27
_LEAST_PART: Final = 2048
_MOST_PARTS: Final = 16


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
        program = build(queue.context, ["records.h", "bins.cl"])
        self._count, self._fill = program.count_tiles, program.fill_tiles

    def fits(self, box: NDArray[np.int32], crop: tuple[int, int, int, int]) -> bool:
        """Whether the lists of all tiles together stay within `MOST_ENTRIES`; they may be some per cent shorter."""
        columns, rows = (-(-(crop[k + 2] - crop[k]) // TILE) + 1 for k in (0, 1))
        if len(box) * columns * rows <= MOST_ENTRIES:
            return True
        across, down = ((box[:, k + 2] - box[:, k]) / np.float32(TILE) + 1 for k in (0, 1))
        return float(across @ down) <= MOST_ENTRIES

    def run(self, box: NDArray[np.int32], crop: tuple[int, int, int, int]) -> Bins:
        """Lists the slots of every tile.

        Args:
            box: (m, 4) int32 pixel boxes inside the crop, half-open, in depth order.
            crop: (x0, y0, x1, y1) in pixels.
        """
        x0, y0 = crop[0] // TILE, crop[1] // TILE
        columns, rows = -(-crop[2] // TILE) - x0, -(-crop[3] // TILE) - y0
        parts = min(max(len(box) // _LEAST_PART, 1), _MOST_PARTS)
        queue = self._queue
        frame = [np.int32(len(box)), np.int32(parts), queue.read_only(box), np.array([x0, y0], dtype=np.int32),
                 np.array([columns, rows], dtype=np.int32)]  # fmt: skip
        counts = np.zeros((parts, columns * rows), dtype=np.int32)
        if len(box):
            queue.run_grid(self._count, (parts, 1), *frame, queue.in_place(counts))
        # Tile by tile, part by part: where each part of each list ends.
        ends = np.cumsum(counts.T, dtype=np.int64).reshape(columns * rows, parts)
        total = int(ends[-1, -1])
        next_place = (ends.T - counts).astype(np.int32)
        entries = queue.kept("entries", total, np.int32)
        if total:
            queue.run_grid(self._fill, (parts, 1), *frame, queue.in_place(next_place), queue.in_place(entries))
        return Bins((x0, y0), columns, rows, ends[:, -1].astype(np.int32), entries)
