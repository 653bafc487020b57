"""The exact image: for each pixel the nearest kept hit over all quadrics, its values and its margins."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Scene
from tests.oracle.band import HALF, Candidate, candidates, normal_condition, separation
from tests.oracle.culling import Culling
from tests.oracle.exact_quadric import ExactQuadric
from tests.oracle.hits import Hit, kept_hits, ray_form
from tests.oracle.rounding import exact, nearest_float32
from tests.oracle.shading import normal, planar_depth, position, ray_distance
from tests.oracle.surd import compare
from tests.oracle.view import View

MISS = -1


@dataclass(frozen=True)
class Truth:
    """Exact answers at n pixels (`image` shapes them (h, w)).

    Attributes:
        hit: bool.
        quadric: int32 index, -1 on a miss; id: uint32, 0 on a miss.
        kind: int8: 0 surface, 1 cap at z0, 2 cap at z1; -1 on a miss.
        depth, distance, back: float32, correctly rounded Z, T and ZBack; the background's depth on a miss.
        normal, position: (..., 3) float64, in the scene's normal space and side and in the world; 0 on a miss.
        margin: float64, relative change below which hit, quadric and kind cannot change (see `band`).
        back_margin: the same for which crossing is the last kept hit.
        condition, back_condition: float64, relative error of Z (ZBack) per relative error of the polynomials.
        normal_condition: float64, error of N's components per relative error of the polynomials.
    """

    hit: NDArray[np.bool_]
    quadric: NDArray[np.int32]
    id: NDArray[np.uint32]
    kind: NDArray[np.int8]
    depth: NDArray[np.float32]
    distance: NDArray[np.float32]
    back: NDArray[np.float32]
    normal: NDArray[np.float64]
    position: NDArray[np.float64]
    margin: NDArray[np.float64]
    back_margin: NDArray[np.float64]
    condition: NDArray[np.float64]
    back_condition: NDArray[np.float64]
    normal_condition: NDArray[np.float64]

    def reshaped(self, *shape: int) -> "Truth":
        """The same values with their pixels laid out anew."""
        return Truth(**{name: array.reshape(*shape, *array.shape[1:]) for name, array in vars(self).items()})


class _Winner(NamedTuple):
    quadric: ExactQuadric
    first: Hit
    last: Hit


class Oracle:
    """A scene set up for exact queries; setting up costs about a millisecond per quadric."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._view = View(scene.camera)
        self._quadrics = [ExactQuadric(self._view, scene.quadrics, k) for k in range(len(scene.quadrics))]
        self._culling = Culling(self._quadrics, HALF)
        background = scene.output.background_depth
        self._background = nearest_float32(exact(background)) if math.isfinite(background) else np.float32(background)

    def pixels(self, pixels: Sequence[tuple[int, int]]) -> Truth:
        """Exact answers at pixels (column i, row j), in order."""
        rows = [self._pixel(i, j) for i, j in pixels]
        columns = list(zip(*rows, strict=True)) if rows else [()] * 14
        dtypes = (bool, np.int32, np.uint32, np.int8, *(np.float32,) * 3, *(np.float64,) * 7)
        arrays = [np.array(column, dtype=dtype) for column, dtype in zip(columns, dtypes, strict=True)]
        return Truth(*arrays)

    def _pixel(self, column: int, row: int) -> tuple[object, ...]:
        i, j = 2 * column + 1, 2 * row + 1
        winner: _Winner | None = None
        near: list[Candidate] = []
        for index in self._culling.candidates(i, j):
            quadric = self._quadrics[index]
            form = ray_form(quadric, i, j)
            near += candidates(quadric, self._view.is_pinhole, form, i, j)
            kept = kept_hits(quadric, form, i, j)
            if kept and (winner is None or compare(kept[0].t, winner.first.t) < 0):
                winner = _Winner(quadric, kept[0], kept[-1])
        if winner is None:
            margin = min((candidate.margin for candidate in near), default=1.0)
            depths = (self._background,) * 3
            return (False, MISS, 0, MISS, *depths, np.zeros(3), np.zeros(3), margin, margin, 1.0, 1.0, 1.0)
        quadric, first, last = winner
        values = (
            planar_depth(first.t),
            ray_distance(self._view, first.t, i, j),
            planar_depth(last.t),
            normal(self._view, self.scene.output, quadric, first, i, j),
            position(self._view, first.t, i, j),
        )
        form = ray_form(quadric, i, j)
        for_normal = normal_condition(quadric, self._view.is_pinhole, form, first, i, j)
        return (True, quadric.index, quadric.id, first.kind, *values, *_margins(winner, near), for_normal)


def image(scene: Scene) -> Truth:
    """The exact image over the camera's crop window, (h, w) shaped."""
    x0, y0, x1, y1 = scene.camera.crop
    return pixels(scene, ((i, j) for j in range(y0, y1) for i in range(x0, x1))).reshaped(y1 - y0, x1 - x0)


def pixels(scene: Scene, pixels: Iterable[tuple[int, int]]) -> Truth:
    """Exact answers at some pixels (column i, row j), in order."""
    return Oracle(scene).pixels(list(pixels))


def _margins(winner: _Winner, near: Sequence[Candidate]) -> tuple[float, float, float, float]:
    """margin, back_margin, condition, back_condition of a hit pixel."""
    own = [candidate for candidate in near if candidate.quadric == winner.quadric.index]
    first = next(candidate for candidate in own if candidate.kept and candidate.hit == winner.first)
    last = next(candidate for candidate in own if candidate.kept and candidate.hit == winner.last)
    margin, back_margin = first.margin, min(candidate.margin for candidate in own)
    for other in near:
        if other is first or (other.kept and _same_surface(other, first)):
            continue
        behind = separation(first, other)
        margin = min(margin, behind if other.kept else max(other.margin, behind))
    return margin, min(margin, back_margin), first.condition, last.condition


def _same_surface(other: Candidate, first: Candidate) -> bool:
    # Two roots of one surface come in a fixed order.
    return other.quadric == first.quadric and other.hit.kind == first.hit.kind
