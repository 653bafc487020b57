"""The textbook's quadratic formula as an OpenCL kernel, one work-item per pixel, on the engine's device.

It gets for nothing what a frame of the engine includes: per-quadric matrices, and lists of the quadrics near each tile
of 16 x 16 pixels, are prepared outside the clock.
"""

from importlib.resources import files
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Scene
from conicoid_bench.forms import forms_of, inexpressible, pixel_boxes, rays_of
from conicoid_bench.picture import Job, Picture

_TILE: Final = 16
Kind = Literal["textbook float32", "textbook float64", "Kahan float64"]
_OPTIONS: Final = {
    "textbook float32": ("-D REAL=float", "-cl-fp32-correctly-rounded-divide-sqrt"),
    "textbook float64": ("-D REAL=double",),
    "Kahan float64": ("-D REAL=double", "-D KAHAN"),
}


class Textbook:
    """One of the kernels.

    Args:
        device: a pyopencl.Device.
    """

    def __init__(self, device: Any, kind: Kind) -> None:
        import pyopencl

        self.name: str = kind
        self._real = np.float32 if "float32" in kind else np.float64
        context = pyopencl.Context([device])
        self._queue = pyopencl.CommandQueue(context)
        source = (files("conicoid_bench") / "textbook.cl").read_text()
        self._kernel = pyopencl.Program(context, source).build([*_OPTIONS[kind]]).trace

    def why_not(self, scene: Scene) -> str | None:
        """It takes shapes with ranges and caps."""
        return inexpressible(scene)

    def prepare(self, scene: Scene) -> Job:
        """Matrices rounded to the kernel's precision, tile lists, buffers."""
        import pyopencl

        queue, real, camera = self._queue, self._real, scene.camera
        forms, width, height = forms_of(scene), camera.width, camera.height
        count = len(scene.quadrics)
        records = np.concatenate([forms.parameter_from_world.reshape(count, 12), forms.form, forms.z_range,
                                  forms.capped[:, None]], axis=1).astype(real)  # fmt: skip
        end, entries = tile_lists(pixel_boxes(scene), width, height)

        def buffer(array: NDArray[Any]) -> Any:
            flags = pyopencl.mem_flags.READ_ONLY | pyopencl.mem_flags.COPY_HOST_PTR
            return pyopencl.Buffer(queue.context, flags, hostbuf=np.ascontiguousarray(array))

        inputs = [buffer(a) for a in (np.stack(rays_of(camera)).astype(real), end, entries, records, forms.id)]
        depth, seen = np.empty((height, width), np.float32), np.empty((height, width), np.uint32)
        normal = np.empty((height, width, 3), np.float32)
        flags = pyopencl.mem_flags.WRITE_ONLY | pyopencl.mem_flags.USE_HOST_PTR
        outputs = [pyopencl.Buffer(queue.context, flags, hostbuf=a) for a in (depth, seen, normal)]
        grid = (-(-width // _TILE) * _TILE, -(-height // _TILE) * _TILE)

        def run() -> None:
            self._kernel(queue, grid, (_TILE, _TILE), np.int32(width), np.int32(height), *inputs, *outputs)
            queue.finish()

        def picture(_: None) -> Picture:
            for array, output in zip((depth, seen, normal), outputs, strict=True):
                pyopencl.enqueue_copy(queue, array, output)
            return Picture(depth, seen, normal)

        return Job(run, picture)


def tile_lists(box: NDArray[np.int64], width: int, height: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Where each tile's list ends, tiles row by row, and all lists: which boxes touch it, in their own order."""
    columns, rows = -(-width // _TILE), -(-height // _TILE)
    low, high = box[:, :2] // _TILE, -(-box[:, 2:] // _TILE)
    size = np.where((box[:, 2:] > box[:, :2]).all(axis=1, keepdims=True), high - low, 0)
    many = size.prod(axis=1)
    owner = np.repeat(np.arange(len(box)), many)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(many) - many, many)
    y, x = np.divmod(place, size[owner, 0])
    tile = (low[owner, 1] + y) * columns + low[owner, 0] + x
    order = np.argsort(tile, kind="stable")
    end = np.cumsum(np.bincount(tile, minlength=columns * rows))
    entries = owner[order] if len(owner) else np.zeros(1)  # OpenCL has no empty buffers
    return end.astype(np.int32), entries.astype(np.int32)
