"""Values that binary64 could not round for certain, in double-double: pixels whose hit is known."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.memory import Queue
from conicoid.program import build
from conicoid.scene import Channel, Scene
from conicoid.setup import Visible, scaled, shape_forms
from conicoid.view import View

# `refined_pixel` in kernels/refine.cl.
_PIXEL: Final = np.dtype(
    [
        ("depth", "f8"), ("x", "i4"), ("y", "i4"), ("quadric", "i4"), ("kind", "i4"), ("certain", "i4"), ("z", "f4"),
        ("t", "f4"), ("n", "f4", 3), ("p", "f4", 3),
    ],
    align=True,
)  # fmt: skip
_WANT: Final[dict[Channel, int]] = {"T": 2, "N": 8, "P": 16}


class Refinement:
    """The double-double stage of one device."""

    def __init__(self, queue: Queue) -> None:
        self._queue = queue
        self._kernel = build(queue.context, ["dd.h", "records.h", "family.h", "refine.cl"]).refine_values
        self._forms = queue.read_only(shape_forms())

    def run(
        self, scene: Scene, view: View, visible: Visible, planes: dict[str, NDArray[Any]], doubts: NDArray[Any]
    ) -> NDArray[np.bool_]:
        """Writes the values of pixels whose first hit is certain into the planes.

        `doubts`, (k,) of `cast.DOUBT`, lists them. Returns which are settled, (k,); none where last hits (`ZBack`) are
        asked for.
        """
        quadrics, camera, output = scene.quadrics, scene.camera, scene.output
        if "ZBack" in output.channels or not len(doubts):
            return np.zeros(len(doubts), dtype=np.bool_)
        pixels = np.zeros(len(doubts), dtype=_PIXEL)
        for field in ("depth", "x", "y"):
            pixels[field] = doubts[field]
        pixels["quadric"], pixels["kind"] = visible.quadric[doubts["winner"] >> 2], doubts["winner"] & 3
        queue = self._queue
        queue.run(self._kernel, -(-len(pixels) // 4), np.int32(len(pixels)), queue.in_place(pixels),
                  queue.read_only(quadrics.world_from_object), queue.read_only(quadrics.radii),
                  queue.read_only(quadrics.shape), self._forms, queue.read_only(quadrics.matrix_row),
                  queue.read_only(scaled(quadrics.matrix)), queue.read_only(quadrics.z_range),
                  queue.read_only(view.rays), np.float64(visible.unit), np.int32(view.orthographic),
                  queue.read_only(view.target), np.array([camera.fx, camera.fy, camera.cx, camera.cy]),
                  np.int32(output.normal_side == "outward"),
                  np.int32(sum(_WANT.get(channel, 0) for channel in output.channels)))  # fmt: skip
        certain: NDArray[np.bool_] = pixels["certain"] != 0
        settled = pixels[certain]
        place = settled["y"] - camera.crop[1], settled["x"] - camera.crop[0]
        for channel, field in (("Z", "z"), ("T", "t")):
            if channel in output.channels:
                planes[channel][place] = settled[field]
        for channel, field in (("N", "n"), ("P", "p")):
            if channel in output.channels:
                for k, axis in enumerate("XYZ"):
                    planes[f"{channel}.{axis}"][place] = settled[field][:, k]
        return certain
