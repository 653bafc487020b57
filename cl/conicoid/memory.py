"""The command queue, buffers over host memory, and launches that stay in PoCL's small-grid variant."""

import math
from typing import Any, Final

import numpy as np
import pyopencl
from numpy.typing import NDArray

# PoCL compiles a second variant of a kernel when one dimension of the grid reaches 65,535.
_GRID: Final = 16384
_ALIGNMENT: Final = 64


class Queue:
    """One device's context and in-order queue; kernels write host arrays in place."""

    def __init__(self, device: "pyopencl.Device") -> None:
        self.device = device
        self.context = pyopencl.Context([device])
        self._queue = pyopencl.CommandQueue(self.context)
        self._kept: dict[str, NDArray[np.uint8]] = {}

    def kept(self, name: str, shape: int | tuple[int, ...], dtype: Any) -> NDArray[Any]:
        """An uninitialised array in memory that the next call with this name gets again, aligned to 64 bytes.

        Fresh pages cost more than most kernels that fill them.
        """
        size = math.prod(shape if isinstance(shape, tuple) else (shape,)) * np.dtype(dtype).itemsize
        memory = self._kept.get(name)
        if memory is None or len(memory) < size:
            memory = self._kept[name] = _aligned(size)
        array: NDArray[Any] = memory[:size].view(dtype).reshape(shape)
        return array

    def read_only(self, array: NDArray[Any]) -> "pyopencl.Buffer":
        """A buffer that reads `array` (made contiguous if it is not); empty arrays give one unused byte."""
        return self._over(np.ascontiguousarray(array), pyopencl.mem_flags.READ_ONLY)

    def in_place(self, array: NDArray[Any]) -> "pyopencl.Buffer":
        """A buffer over the memory of a contiguous array; holds results after the launch that wrote it."""
        return self._over(array, pyopencl.mem_flags.READ_WRITE)

    def empty(self, size: int) -> "pyopencl.Buffer":
        """Uninitialised device memory of `size` bytes (at least one)."""
        return pyopencl.Buffer(self.context, pyopencl.mem_flags.READ_WRITE, max(int(size), 1))

    def run(self, kernel: "pyopencl.Kernel", items: int, *arguments: Any) -> None:
        """Launch over at least `items` work-items (the kernel tests its index) and wait."""
        columns = min(items, _GRID)
        self.run_grid(kernel, (columns, -(-items // columns)), *arguments)

    def run_grid(self, kernel: "pyopencl.Kernel", grid: tuple[int, int], *arguments: Any) -> None:
        """Launch over a two-dimensional grid of single work-items and wait."""
        kernel(self._queue, grid, (1, 1), *arguments)
        self._queue.finish()

    def _over(self, array: NDArray[Any], access: int) -> "pyopencl.Buffer":
        if not array.size:
            return self.empty(1)
        return pyopencl.Buffer(self.context, access | pyopencl.mem_flags.USE_HOST_PTR, hostbuf=array)


def _aligned(size: int) -> NDArray[np.uint8]:
    """That many uninitialised bytes, at a multiple of `_ALIGNMENT`."""
    memory = np.empty(size + _ALIGNMENT, dtype=np.uint8)
    start = -memory.ctypes.data % _ALIGNMENT
    return memory[start : start + size]
