"""Per pixel: every tile's quadrics evaluated, the nearest kept, the channels written."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.bins import Bins
from conicoid.device import describe
from conicoid.memory import Queue
from conicoid.program import build
from conicoid.scene import PLANES, Precision, Scene
from conicoid.setup import Visible
from conicoid.view import View

_FILES: Final = [
    "records.h", "lanes.h", "polynomials.h", "tile.h", "certify.h", "places.h", "offer.h", "general_tile.h",
    "extents.h", "candidates.h", "general.h", "normals.h", "simple.h", "winners.h", "channels.h", "cast.cl",
]  # fmt: skip
_WANT: Final = {"Z": 1, "T": 2, "ZBack": 4, "N": 8, "P": 16, "id": 32, "A": 64}
# `frame` in kernels/tile.h.
_FRAME: Final = np.dtype(
    [
        ("rays", "f8", (6, 3)), ("back", "f8", (3, 3)), ("axes", "f8", (3, 3)), ("principal", "f8", 2),
        ("slant", "f8", (2, 2)), ("unit", "f8"), ("near", "f8"),
        ("far", "f8"), ("background", "f4"), ("channels", "i4"), ("capacity", "i4"), ("orthographic", "i4"),
        ("outward", "i4"), ("crop", "i4", (4,)), ("tile_origin", "i4", (2,)), ("columns", "i4"),
    ],
    align=True,
)  # fmt: skip
# `doubtful_pixel` there.
DOUBT: Final = np.dtype(
    [("depth", "f8"), ("x", "i4"), ("y", "i4"), ("winner", "i4"), ("rival", "i4"), ("reasons", "i4")], align=True
)
_HAS_RANGE: Final = 1
_FIRST_CAPACITY: Final = 4096


def _arithmetic(precision: Precision, visible: Visible) -> Precision:
    """`float64` where binary32 cannot tell what an extent keeps: quadrics seen from over 128 times their extent."""
    if precision != "float32" or not len(visible.general):
        return precision
    general = visible.general
    along, across = np.abs(general["x"][:, 2, 2]), np.abs(general["x"][:, :, 2]).max(axis=1)
    span = np.abs(general["range"][:, 0, 2] - general["range"][:, 1, 2])
    ranged = (general["flags"] & _HAS_RANGE) != 0
    far = (ranged & (along > 128 * span)) | ((general["clip_count"][:, 0] > 0) & (across > 128))
    return "float64" if far.any() else precision


class Caster:
    """The casting kernels of one device, one program for each precision."""

    def __init__(self, queue: Queue) -> None:
        self._queue = queue
        lanes = describe(queue.device).double_lanes
        self._kernels = {
            precision: build(
                queue.context, _FILES, {"REAL_BITS": bits, "LANES": lanes * 64 // bits, "EXACT": int(exact)}
            ).cast_tiles
            for precision, bits, exact in (("exact", 64, True), ("float64", 64, False), ("float32", 32, False))
        }
        self._doubts = np.empty(_FIRST_CAPACITY, dtype=DOUBT)

    def run(
        self, scene: Scene, view: View, visible: Visible, bins: Bins
    ) -> tuple[dict[str, NDArray[Any]], NDArray[Any]]:
        """Casts the crop.

        Returns:
            Planes named as in EXR, in memory that the next run writes over, and the pixels in doubt, (k,) of DOUBT:
            those that `exact` casting could not certify.
        """
        queue, camera, output = self._queue, scene.camera, scene.output
        x0, y0, x1, y1 = camera.crop
        height, width = y1 - y0, x1 - x0
        # A tight data window is found from the mask.
        channels = {*output.channels, "A"} if output.data_window == "tight" else {*output.channels}
        wanted = [name for name in PLANES if name in channels]
        names = [plane for name in wanted for plane in PLANES[name]]
        planes = queue.kept("planes", (len(names) + ("id" in channels), height, width), np.float32)
        floats = planes[: len(names)]
        ids = planes[len(names) :].view(np.uint32)

        unit = visible.unit
        frame = np.zeros(1, dtype=_FRAME)
        frame["rays"] = view.rays[:, :, 0]
        frame["back"] = view.back
        frame["axes"] = -view.image_rows @ view.target
        frame["axes"][0, 2] *= 1 / unit if view.orthographic else 1
        frame["principal"] = view.principal
        if not view.orthographic:
            frame["slant"] = [[1 / camera.fx, -camera.cx / camera.fx], [1 / camera.fy, -camera.cy / camera.fy]]
        frame["unit"], frame["near"], frame["far"] = unit, camera.near / unit, camera.far / unit
        with np.errstate(over="ignore"):
            frame["background"] = output.background_depth
        frame["channels"] = sum(_WANT[name] for name in channels)
        frame["orthographic"], frame["outward"] = view.orthographic, output.normal_side == "outward"
        frame["crop"], frame["tile_origin"], frame["columns"] = camera.crop, bins.origin, bins.columns
        kernel, doubts = self._kernels[_arithmetic(output.precision, visible)], self._doubts
        inputs = [
            queue.read_only(array)
            for array in (bins.end, bins.entries, visible.slots, visible.general, visible.clips, visible.place,
                          visible.planes, scene.quadrics.id)
        ]  # fmt: skip
        while True:
            count = np.zeros(1, dtype=np.int32)
            frame["capacity"] = len(doubts)
            results = [queue.in_place(array) for array in (floats, ids, count, doubts)]
            queue.run_grid(kernel, (bins.columns, bins.rows), queue.read_only(frame), *inputs, *results)
            if count[0] <= len(doubts):
                break
            doubts = np.empty(int(count[0]), dtype=DOUBT)
        result: dict[str, NDArray[Any]] = dict(zip(names, floats, strict=True))
        if "id" in channels:
            result["id"] = ids[0]
        return result, doubts[: count[0]]
