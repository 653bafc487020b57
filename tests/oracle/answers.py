"""The exact answers alone: what `Oracle` gives but for the margins, at half the cost."""

import numpy as np

from conicoid.scene import Scene
from tests.oracle.exact_image import MISS, Oracle, Truth
from tests.oracle.exact_quadric import ExactQuadric
from tests.oracle.hits import Hit, kept_hits, ray_form
from tests.oracle.shading import normal, planar_depth, position, ray_distance
from tests.oracle.surd import compare

UNKNOWN = (float("nan"),) * 5


class Answers(Oracle):
    """An oracle whose margins and conditions are NaN."""

    def _pixel(self, column: int, row: int) -> tuple[object, ...]:
        i, j = 2 * column + 1, 2 * row + 1
        winner: ExactQuadric | None = None
        hits: list[Hit] = []
        for index in self._culling.candidates(i, j):
            quadric = self._quadrics[index]
            kept = kept_hits(quadric, ray_form(quadric, i, j), i, j)
            if kept and (winner is None or compare(kept[0].t, hits[0].t) < 0):
                winner, hits = quadric, kept
        if winner is None:
            return (False, MISS, 0, MISS, *(self._background,) * 3, np.zeros(3), np.zeros(3), *UNKNOWN)
        first = hits[0]
        return (
            True, winner.index, winner.id, first.kind,
            planar_depth(first.t), ray_distance(self._view, first.t, i, j), planar_depth(hits[-1].t),
            normal(self._view, self.scene.output, winner, first, i, j), position(self._view, first.t, i, j), *UNKNOWN,
        )  # fmt: skip


def answers(scene: Scene) -> Truth:
    """The exact image over the crop, (h, w) shaped."""
    x0, y0, x1, y1 = scene.camera.crop
    return Answers(scene).pixels([(i, j) for j in range(y0, y1) for i in range(x0, x1)]).reshaped(y1 - y0, x1 - x0)
