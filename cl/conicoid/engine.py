"""The engine's front: a resolved scene in, planes of pixels out."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.bins import Binning
from conicoid.cast import Caster
from conicoid.device import describe, find_device
from conicoid.memory import Queue
from conicoid.scene import Scene
from conicoid.setup import Setup
from conicoid.view import view_of


@dataclass(frozen=True)
class Frame:
    """One rendered view.

    Attributes:
        planes: EXR channel name (`Z`, `T`, `ZBack`, `N.X`, ..., `P.X`, ..., `id`, `A`) to a C-contiguous (h, w)
            float32 array, uint32 for `id`; row 0 is the top row of `window`. They share the renderer's memory and
            last until its next render.
        window: (x0, y0, x1, y1), half-open, the data window in pixels of the whole image.
        setup_ms: time spent per quadric: bounds, records, bins.
        cast_ms: time spent per pixel.
    """

    planes: dict[str, NDArray[Any]]
    window: tuple[int, int, int, int]
    setup_ms: float
    cast_ms: float


class Renderer:
    """An OpenCL device with its kernels built; not thread-safe, use one per process.

    Args:
        device: part of "platform name version device"; None reads `CONICOID_DEVICE`.
    Raises:
        DeviceError: there is no such device.
        KernelError: a kernel did not build.
    """

    def __init__(self, device: str | None = None) -> None:
        queue = Queue(find_device(device))
        self.device = describe(queue.device)
        self._setup, self._binning, self._caster = Setup(queue), Binning(queue), Caster(queue)

    def render(self, scene: Scene) -> Frame:
        """Cast every pixel of the crop."""
        start = time.perf_counter()
        view = view_of(scene.camera, scene.output)
        visible = self._setup.run(scene.quadrics, scene.camera, view, want_back="ZBack" in scene.output.channels)
        bins = self._binning.run(visible.box, scene.camera.crop)
        cast_start = time.perf_counter()
        planes, window = self._caster.run(scene, view, visible, bins), scene.camera.crop
        if scene.output.data_window == "tight":
            planes, window = _tighten(planes, window)
        planes = {name: plane for name, plane in planes.items() if name.split(".")[0] in scene.output.channels}
        end = time.perf_counter()
        return Frame(planes, window, 1e3 * (cast_start - start), 1e3 * (end - cast_start))


def _tighten(
    planes: dict[str, NDArray[Any]], window: tuple[int, int, int, int]
) -> tuple[dict[str, NDArray[Any]], tuple[int, int, int, int]]:
    """The bounding box of the hits; the window's top left pixel where nothing is hit."""
    x0, y0 = window[:2]
    columns, rows = np.flatnonzero(planes["A"].any(axis=0)), np.flatnonzero(planes["A"].any(axis=1))
    left, right = (int(columns[0]), int(columns[-1]) + 1) if len(columns) else (0, 1)
    top, bottom = (int(rows[0]), int(rows[-1]) + 1) if len(rows) else (0, 1)
    cut = {name: np.ascontiguousarray(plane[top:bottom, left:right]) for name, plane in planes.items()}
    return cut, (x0 + left, y0 + top, x0 + right, y0 + bottom)
