"""The floor: a kernel that fills four planes of an image in row order with plain vector stores, and does nothing else.

No ray-caster can be faster than the memory that it writes, unless it streams past the cache.
"""

import time

import numpy as np
import pyopencl

from conicoid.device import find_device
from conicoid.memory import Queue

_LANES = 8
_FILL = """
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void fill_row(__global float8 *planes, int vectors)
{
    __global float8 *row = planes + (long)get_global_id(0) * vectors;
    for (int k = 0; k < vectors; k++)
        row[k] = (float8)(1.0f);
}
"""


class WriteOnly:
    """Z and N of one image size, written again and again to the same buffer.

    Args:
        device: as for the engine.
        height, width: pixels.
    """

    def __init__(self, device: str | None, height: int, width: int) -> None:
        self._queue = Queue(find_device(device))
        self._kernel = pyopencl.Program(self._queue.context, _FILL).build().fill_row
        self._rows, self._vectors = 4 * height, -(-width // _LANES)
        self._planes = self._queue.empty(4 * _LANES * self._rows * self._vectors)
        self.lap()

    def lap(self) -> float:
        """Milliseconds of one launch."""
        start = time.perf_counter()
        self._queue.run_grid(self._kernel, (self._rows, 1), self._planes, np.int32(self._vectors))
        return 1e3 * (time.perf_counter() - start)
