"""Where each quadric can be in its own object space, and what kind of form it has; no camera involved."""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Floats, Quadrics
from conicoid.shapes import SHAPES

UNBOUNDED: Final = 0
ELLIPSOID: Final = 1
BOX: Final = 2

ALWAYS_REAL: Final = 4
SINGULAR: Final = 8
RISING: Final = 128

_CODE: Final = {shape.name: shape.code for shape in SHAPES}
# Shapes that are bounded as a whole, by code.
_CLOSED: Final = np.array([shape.name in {"sphere", "ellipsoid"} for shape in SHAPES])
_MAY_LIE_IN_AN_END: Final = np.array([shape.name in {"plane", "parallel_planes"} for shape in SHAPES])
_PAIRS_OF_PLANES: Final = np.array([shape.name in {"plane", "parallel_planes", "crossed_planes"} for shape in SHAPES])
_RISING: Final = np.array([shape.name != "quadric" and min(shape.squares) >= 0 for shape in SHAPES])
# Widens every computed size: a box may be too large by this, never too small.
_SLACK: Final = 1 + 2.0**-40


@dataclass(frozen=True)
class Extent:
    """Object-space bounds of n quadrics.

    Attributes:
        kind: (n,) uint8: UNBOUNDED, ELLIPSOID (the whole surface, half-axes `half`) or BOX.
        centre, half: (n, 3) float64, middle and half size of the bounding box along the object axes.
        flags: (n,) int32, ALWAYS_REAL, SINGULAR and RISING of `kernels/records.h`.
        whole: (n,) bool, ellipsoids without extent of any kind.
    """

    kind: NDArray[np.uint8]
    centre: Floats
    half: Floats
    flags: NDArray[np.int32]
    whole: NDArray[np.bool_]


@dataclass(frozen=True)
class Model:
    """Quadrics and what follows from them whatever the camera.

    Attributes:
        quadrics: as given, but for ends of ranges that lie in planes (`clear_of_planes`).
        extent: their bounds in object space.
    """

    quadrics: Quadrics
    extent: Extent


def model_of(quadrics: Quadrics) -> Model:
    """Everything that cameras share."""
    quadrics = replace(quadrics, z_range=clear_of_planes(quadrics))
    return Model(quadrics, extent_of(quadrics))


def extent_of(quadrics: Quadrics) -> Extent:
    """Bounds every quadric by its shape, radii and z_range; clips are ignored, which is conservative."""
    count = len(quadrics)
    whole = _CLOSED[quadrics.shape]
    ranged = np.isfinite(quadrics.z_range[:, 0])
    if ranged.any():
        whole &= ~ranged
    centre, half = np.zeros((count, 3)), quadrics.radii * _SLACK
    kind, flags = np.full(count, ELLIPSOID, dtype=np.uint8), np.zeros(count, dtype=np.int32)
    rest = np.flatnonzero(~whole)
    if len(rest):
        kind[rest], centre[rest], half[rest], flags[rest] = _bounded(quadrics, rest)
    if len(quadrics.clip):
        whole &= np.diff(quadrics.clip_start) == 0
    return Extent(kind, centre, half, flags, whole)


def _bounded(quadrics: Quadrics, rows: NDArray[np.intp]) -> tuple[NDArray[np.uint8], Floats, Floats, NDArray[np.int32]]:
    """Kind, centre, half size and flags of some quadrics that are not whole ellipsoids."""
    shape, radii = quadrics.shape.take(rows), quadrics.radii.take(rows, axis=0)
    low, high = quadrics.z_range.take(rows, axis=0).T.copy()
    ranged = np.isfinite(low)
    centre, half = np.zeros((len(rows), 3)), np.full((len(rows), 3), np.inf)
    closed = _CLOSED[shape]
    half[closed] = radii[closed]
    with np.errstate(over="ignore", invalid="ignore"):
        tallest = np.maximum(np.abs(low), np.abs(high))
        height = tallest / radii[:, 2]
        for name, widening in (
            ("cylinder", np.ones(len(rows))),
            ("cone", tallest),
            ("paraboloid", np.sqrt(np.maximum(high, 0))),
            ("hyperboloid_one_sheet", np.sqrt(1 + height * height)),
            ("hyperboloid_two_sheets", np.sqrt(np.maximum(height * height - 1, 0))),
        ):
            chosen = ranged & (shape == _CODE[name])
            half[chosen, :2] = radii[chosen, :2] * widening[chosen, None]
    flags = (ALWAYS_REAL * _PAIRS_OF_PLANES[shape] | RISING * _RISING[shape]).astype(np.int32)
    for row in np.flatnonzero(shape == _CODE["quadric"]):
        matrix = quadrics.matrix[quadrics.matrix_row[rows[row]]]
        centre[row], half[row] = _definite_box(matrix)
        flags[row] = _form_flags(matrix)
    low[~ranged] = (centre - half)[~ranged, 2]
    high[~ranged] = (centre + half)[~ranged, 2]
    with np.errstate(over="ignore", invalid="ignore"):
        low = np.maximum(low, (centre - half)[:, 2], where=np.isfinite(half[:, 2]), out=low)
        high = np.minimum(high, (centre + half)[:, 2], where=np.isfinite(half[:, 2]), out=high)
        centre[:, 2] = np.where(np.isfinite(half[:, 2]) | ranged, low / 2 + high / 2, 0)
        half[:, 2] = np.where(np.isfinite(half[:, 2]) | ranged, np.maximum(high / 2 - low / 2, 0), np.inf)
        half *= _SLACK
    bounded = np.isfinite(half).all(axis=1) & np.isfinite(centre).all(axis=1)
    centre[~bounded] = 0
    half[~bounded] = 0
    return np.where(bounded, BOX, UNBOUNDED).astype(np.uint8), centre, half, flags


def clear_of_planes(quadrics: Quadrics) -> Floats:
    """(n, 2) float64 z_range, moved off planes that the surface itself lies in; it keeps the same points.

    `plane` is z = 0 and `parallel_planes` z = -c and c, so whether a sheet is kept is known here; a range that ends on
    one would leave every pixel of it to exact arithmetic. Caps need the ends as they are.
    """
    if not _MAY_LIE_IN_AN_END[quadrics.shape].any():
        return quadrics.z_range
    z_range = quadrics.z_range.copy()
    ranged = np.isfinite(z_range[:, 0]) & ~quadrics.capped
    for name, has_sheets in (("plane", False), ("parallel_planes", True)):
        rows = np.flatnonzero(ranged & (quadrics.shape == _CODE[name]))
        low, high = z_range[rows, 0], z_range[rows, 1]
        c = quadrics.radii[rows, 2] if has_sheets else np.zeros(len(rows))
        unit = np.where(c > 0, 2 * c, 1.0)
        # Ends between or beyond the sheets; with one plane both sheets are z = 0.
        between = 0.0 if has_sheets else unit
        z_range[rows, 0] = np.where(low <= -c, -unit, np.where(low <= c, between, unit))
        z_range[rows, 1] = np.where(high >= c, unit, np.where(high >= -c, between, -unit))
    return z_range


def _definite_box(matrix: Floats) -> tuple[Floats, Floats]:
    """Centre and half size of x^T Q x = 0 where Q's 3x3 part is safely definite; infinite elsewhere."""
    unbounded = np.zeros(3), np.full(3, np.inf)
    scale = np.abs(matrix).max()
    upper, linear, constant = matrix[:3, :3] / scale, matrix[:3, 3] / scale, matrix[3, 3] / scale
    if upper[0, 0] < 0:
        upper, linear, constant = -upper, -linear, -constant
    values = np.linalg.eigvalsh(upper)
    if not values[0] > 2.0**-20 * values[2]:
        return unbounded
    inverse = np.linalg.inv(upper)
    centre = -inverse @ linear
    # Cancellation in r^2 is covered by adding its own rounding error, 2^-24 of the terms with room to spare.
    square = float(linear @ inverse @ linear - constant)
    square += 2.0**-24 * (float(np.abs(linear) @ np.abs(inverse) @ np.abs(linear)) + abs(constant))
    if not square >= 0:
        return centre, np.zeros(3)
    half = np.sqrt(np.diag(inverse) * square) * (1 + 2.0**-20) + 2.0**-24 * np.abs(centre)
    return centre, half


def _form_flags(matrix: Floats) -> int:
    """ALWAYS_REAL for plane pairs, SINGULAR for semidefinite forms, decided in exact arithmetic."""
    positive, negative = _inertia([[Fraction(float(value)) for value in row] for row in matrix])
    flags = 0
    if positive <= 1 and negative <= 1:
        flags |= ALWAYS_REAL
    if positive == 0 or negative == 0:
        flags |= SINGULAR
    return flags


def _inertia(rows: list[list[Fraction]]) -> tuple[int, int]:
    """How many positive and negative squares a symmetric matrix has (Sylvester), by congruence elimination."""
    rows = [row[:] for row in rows]
    positive = negative = 0
    while rows:
        size = len(rows)
        pivot = next((i for i in range(size) if rows[i][i]), None)
        if pivot is None:
            pair = next(((i, j) for i in range(size) for j in range(i) if rows[i][j]), None)
            if pair is None:
                break
            i, j = pair
            # x_j := x_j + x_i gives 2 r_ij on the diagonal.
            rows[i] = [x + y for x, y in zip(rows[i], rows[j], strict=True)]
            for row in rows:
                row[i] += row[j]
            pivot = i
        value = rows[pivot][pivot]
        positive, negative = positive + (value > 0), negative + (value < 0)
        rest = [k for k in range(size) if k != pivot]
        rows = [[rows[i][j] - rows[i][pivot] * rows[pivot][j] / value for j in rest] for i in rest]
    return positive, negative
