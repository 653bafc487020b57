"""Per pixel: every tile's quadrics evaluated, the nearest kept, the channels written."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.bins import Bins
from conicoid.device import describe
from conicoid.memory import Queue
from conicoid.program import build
from conicoid.scene import Scene
from conicoid.setup import Visible
from conicoid.view import View

_FILES: Final = [
    "records.h", "lanes.h", "polynomials.h", "candidates.h", "normals.h", "tile.h", "channels.h", "cast.cl"
]  # fmt: skip
_WANT: Final = {"Z": 1, "T": 2, "ZBack": 4, "N": 8, "P": 16, "id": 32, "A": 64}
# Planes lie in this order, whatever order the document asks them in.
_PLANES: Final = {
    "Z": ("Z",), "T": ("T",), "ZBack": ("ZBack",), "N": ("N.X", "N.Y", "N.Z"), "P": ("P.X", "P.Y", "P.Z"), "A": ("A",)
}  # fmt: skip
# `frame` in kernels/tile.h.
_FRAME: Final = np.dtype(
    [
        ("rays", "f8", (6, 3)), ("back", "f8", (3, 3)), ("slant", "f8", (2, 2)), ("unit", "f8"), ("near", "f8"),
        ("far", "f8"), ("background", "f4"), ("channels", "i4"), ("orthographic", "i4"), ("outward", "i4"),
        ("crop", "i4", (4,)), ("tile_origin", "i4", (2,)), ("columns", "i4"),
    ],
    align=True,
)  # fmt: skip
_ALIGNMENT: Final = 64


class Caster:
    """The casting kernels of one device, one program for each precision."""

    def __init__(self, queue: Queue) -> None:
        self._queue = queue
        lanes = describe(queue.device).double_lanes
        self._kernels = {
            bits: build(queue.context, _FILES, {"REAL_BITS": bits, "LANES": lanes * 64 // bits}).cast_tiles
            for bits in (64, 32)
        }
        self._memory = np.empty(0, dtype=np.uint8)

    def run(self, scene: Scene, view: View, visible: Visible, bins: Bins) -> dict[str, NDArray[Any]]:
        """Planes of the crop, named as in EXR; they live in memory that the next run writes over."""
        queue, camera, output = self._queue, scene.camera, scene.output
        x0, y0, x1, y1 = camera.crop
        height, width = y1 - y0, x1 - x0
        # A tight data window is found from the mask.
        channels = {*output.channels, "A"} if output.data_window == "tight" else {*output.channels}
        wanted = [name for name in _PLANES if name in channels]
        names = [plane for name in wanted for plane in _PLANES[name]]
        planes = self._planes(len(names) + ("id" in channels), height, width)
        floats = planes[: len(names)]
        ids = planes[len(names) :].view(np.uint32)

        unit = visible.unit
        frame = np.zeros(1, dtype=_FRAME)
        frame["rays"] = view.rays[:, :, 0]
        frame["back"] = view.back
        if not view.orthographic:
            frame["slant"] = [[1 / camera.fx, -camera.cx / camera.fx], [1 / camera.fy, -camera.cy / camera.fy]]
        frame["unit"], frame["near"], frame["far"] = unit, camera.near / unit, camera.far / unit
        with np.errstate(over="ignore"):
            frame["background"] = output.background_depth
        frame["channels"] = sum(_WANT[name] for name in channels)
        frame["orthographic"], frame["outward"] = view.orthographic, output.normal_side == "outward"
        frame["crop"], frame["tile_origin"], frame["columns"] = camera.crop, bins.origin, bins.columns
        # Bounds in the kernels' keys; widened because binary32 casting rounds them.
        with np.errstate(divide="ignore"):
            depth = visible.nearest * ((1 - 2.0**-20) / unit)
            nearest_key = -depth if view.orthographic else 1 / depth
        kernel = self._kernels[32 if output.precision == "float32" else 64]
        queue.run_grid(kernel, (bins.columns, bins.rows), queue.read_only(frame), queue.read_only(bins.end),
                       bins.entries, queue.read_only(visible.box), queue.read_only(nearest_key),
                       queue.read_only(visible.record), queue.read_only(visible.quadric),
                       queue.read_only(scene.quadrics.id[visible.quadric]), visible.simple, visible.general,
                       visible.clips, queue.in_place(floats), queue.in_place(ids))  # fmt: skip
        result: dict[str, NDArray[Any]] = dict(zip(names, floats, strict=True))
        if "id" in channels:
            result["id"] = ids[0]
        return result

    def _planes(self, count: int, height: int, width: int) -> NDArray[np.float32]:
        """Reused memory, aligned for vector stores: fresh pages cost more than casting."""
        size = 4 * count * height * width
        if len(self._memory) < size + _ALIGNMENT:
            self._memory = np.empty(size + _ALIGNMENT, dtype=np.uint8)
        start = -self._memory.ctypes.data % _ALIGNMENT
        return self._memory[start : start + size].view(np.float32).reshape(count, height, width)
