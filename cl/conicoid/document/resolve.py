"""Columns of a document to the arrays of a scene: parameters in full, placements as one matrix, defaults filled in."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.document.variants import Group
from conicoid.scene import Floats, Output, Quadrics
from conicoid.shapes import SHAPES, Shape

_SHAPES = {shape.name: shape for shape in SHAPES}
# Where the ten coefficients [A, B, C, D, E, F, G, H, I, J] stand in Q: f = Ax^2 + 2Bxy + ... + J = x^T Q x.
_COEFFICIENT_OF_ENTRY = np.array([[0, 1, 2, 3], [1, 4, 5, 6], [2, 5, 7, 8], [3, 6, 8, 9]])


def resolve_quadrics(groups: list[Group]) -> Quadrics:
    """The quadrics of all groups in document order."""
    n = sum(len(group.index) for group in groups)
    shape = np.zeros(n, np.uint8)
    radii = np.ones((n, 3))
    world_from_object = np.zeros((n, 3, 4))
    ids = np.arange(1, n + 1, dtype=np.uint32)
    z_range = np.tile([-np.inf, np.inf], (n, 1))
    capped = np.zeros(n, bool)
    names: dict[int, str] = {}
    for group in groups:
        index, columns = group.index, group.columns
        shape[index] = _SHAPES[group.variant].code
        radii[index] = _radii(_SHAPES[group.variant], columns, len(index))
        world_from_object[index] = _placements(columns, len(index))
        for key, array in (("id", ids), ("z_range", z_range), ("capped", capped)):
            if key in columns:
                array[index] = columns[key]
        names |= zip(index.tolist(), columns.get("name", []), strict=False)
    matrix, matrix_row = _matrices(groups, n)
    clip, clip_start = _clips(groups, n)
    return Quadrics(
        shape=shape,
        radii=radii,
        matrix_row=matrix_row,
        matrix=matrix,
        world_from_object=world_from_object,
        id=ids,
        z_range=z_range,
        capped=capped,
        clip=clip,
        clip_start=clip_start,
        name=dict(sorted(names.items())),
    )


def _radii(shape: Shape, columns: dict[str, Any], n: int) -> Floats:
    """(n, 3) radii (a, b, c), 1 where the shape has no such radius."""
    radii = np.ones((n, 3))
    if "radii" in columns:
        radii[:, : shape.radii] = columns["radii"]
    elif "radius" in columns:
        radii[:, _axes_of_radius(shape)] = columns["radius"][:, None]
    return radii


def _axes_of_radius(shape: Shape) -> list[int]:
    """The axes that a shape's one `radius` scales: those whose squares its f has."""
    return [axis for axis, square in enumerate(shape.squares) if square and (axis < 2 or shape.radii != 2)]


def _placements(columns: dict[str, Any], n: int) -> Floats:
    """(n, 3, 4) world_from_object."""
    if "transform" in columns:
        return np.asarray(columns["transform"])[:, :3]
    placements = np.zeros((n, 3, 4))
    placements[:, :, :3] = rotation_matrices(columns["rotation"]) if "rotation" in columns else np.eye(3)
    placements[:, :, 3] = columns.get("center", 0.0)
    return placements


def rotation_matrices(quaternions: Floats) -> Floats:
    """(n, 4) quaternions [x, y, z, w] of any length but 0 to (n, 3, 3) rotations.

    A fixed sequence of binary64 operations, each correctly rounded, in the order written here and in docs/scene.md.
    The quaternion is first scaled by the power of two that brings its largest component into [1/2, 1), so that nothing
    overflows or is lost; products are divided by its squared length, so that no square root is needed and turns by
    multiples of 90 degrees come out exact.
    """
    largest = np.abs(quaternions).max(axis=1, keepdims=True)
    x, y, z, w = np.ldexp(quaternions, -np.frexp(largest)[1]).T
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    xy, xz, yz, xw, yw, zw = x * y, x * z, y * z, x * w, y * w, z * w
    length2 = (xx + yy) + (zz + ww)
    rows = [
        [((xx + ww) - (yy + zz)) / ((xx + ww) + (yy + zz)), 2 * (xy - zw) / length2, 2 * (xz + yw) / length2],
        [2 * (xy + zw) / length2, ((yy + ww) - (xx + zz)) / ((yy + ww) + (xx + zz)), 2 * (yz - xw) / length2],
        [2 * (xz - yw) / length2, 2 * (yz + xw) / length2, ((zz + ww) - (xx + yy)) / ((zz + ww) + (xx + yy))],
    ]
    return np.array(rows).transpose(2, 0, 1) + 0.0


def _matrices(groups: list[Group], n: int) -> tuple[Floats, NDArray[np.int32]]:
    """The (m, 4, 4) forms of the shape `quadric` in document order, and each quadric's row of them."""
    given = [group for group in groups if group.variant == "quadric"]
    matrix_row = np.full(n, -1, np.int32)
    for group in given:
        matrix_row[group.index] = 0
    members = matrix_row == 0
    matrix_row[members] = np.arange(members.sum())
    matrix = np.zeros((int(members.sum()), 4, 4))
    for group in given:
        columns = group.columns
        forms = columns["matrix"] if "matrix" in columns else columns["coefficients"][:, _COEFFICIENT_OF_ENTRY]
        matrix[matrix_row[group.index]] = forms
    return matrix, matrix_row


def _clips(groups: list[Group], n: int) -> tuple[Floats, NDArray[np.int32]]:
    """The clip planes of all quadrics in document order, and where each quadric's begin."""
    given = [(group.index, group.columns["clip"]) for group in groups if "clip" in group.columns]
    counts = np.zeros(n, np.int64)
    for index, clip in given:
        counts[index] = clip.counts
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    if not given:
        return np.zeros((0, 4)), start
    owners = np.concatenate([np.repeat(index, clip.counts) for index, clip in given])
    rows = np.concatenate([clip.rows for _, clip in given])
    return rows[np.argsort(owners, kind="stable")], start


def resolve_output(columns: dict[str, Any]) -> Output:
    """The output of a document's one `output` object, given as columns of length 1."""
    lists = {key: column.tolist() if isinstance(column, np.ndarray) else column for key, column in columns.items()}
    return Output(**{key: values[0] for key, values in lists.items()})
