"""Columns of a document to the arrays of a scene: parameters in full, placements as one matrix, defaults filled in."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.document.variants import Group
from conicoid.scene import MOST_EXPANDED, Floats, KeptSet, Output, Quadrics
from conicoid.shapes import SHAPES, Shape

_BLOCK: Final = 1 << 13  # rows at a time, so that what is between lies in the cache
_SHAPES = {shape.name: shape for shape in SHAPES}
# Where the ten coefficients [A, B, C, D, E, F, G, H, I, J] stand in Q: f = Ax^2 + 2Bxy + ... + J = x^T Q x.
_COEFFICIENT_OF_ENTRY = np.array([[0, 1, 2, 3], [1, 4, 5, 6], [2, 5, 7, 8], [3, 6, 8, 9]])


def resolve_quadrics(groups: list[Group]) -> Quadrics:
    """The quadrics of all groups in document order, every element of a set one of them."""
    names, sets = _names(groups)
    groups = [group.expanded() for group in groups]
    n = sum(map(len, groups))
    shape = np.zeros(n, np.uint8)
    radii = np.ones((n, 3))
    world_from_object = np.zeros((n, 3, 4))
    ids = np.arange(1, n + 1, dtype=np.uint32)
    z_range = np.tile([-np.inf, np.inf], (n, 1))
    capped = np.zeros(n, bool)
    for group in groups:
        at, columns = _places(group.index), group.columns
        shape[at] = _SHAPES[group.variant].code
        _set_radii(radii, at, _SHAPES[group.variant], columns)
        _set_placements(world_from_object, at, columns)
        for key, array in (("id", ids), ("z_range", z_range), ("capped", capped)):
            if key in columns:
                array[at] = columns[key]
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
        name=names,
        sets=sets,
    )


def _places(index: NDArray[np.int64]) -> slice | NDArray[np.int64]:
    """Ascending positions as a slice where they have no gaps: many times faster to write to."""
    if len(index) and index[-1] - index[0] == len(index) - 1:
        return slice(int(index[0]), int(index[-1]) + 1)
    return index


def _names(groups: list[Group]) -> tuple[dict[int, str], tuple[KeptSet, ...]]:
    """Names by position, and the sets that are kept, which hold their own."""
    names: dict[int, str] = {}
    sets: list[KeptSet] = []
    for group in groups:
        column = group.columns.get("name")
        if group.counts is None:
            names |= zip(group.index.tolist(), column or [], strict=False)
            continue
        given = [None] * len(group.index) if column is None else column.split()
        for start, count, name in zip(group.index.tolist(), group.counts.tolist(), given, strict=True):
            if count > MOST_EXPANDED:
                sets.append(KeptSet(start, start + count, name))
            elif name is not None:
                each = [name] * count if isinstance(name, str) else name
                names |= zip(range(start, start + count), each, strict=True)
    return dict(sorted(names.items())), tuple(sorted(sets, key=lambda kept: kept.start))


def _set_radii(radii: Floats, at: slice | NDArray[np.int64], shape: Shape, columns: dict[str, Any]) -> None:
    """Write the radii (a, b, c) that a shape has into rows of (n, 3)."""
    if "radii" in columns:
        for axis in range(shape.radii):
            radii[at, axis] = columns["radii"][:, axis]
    elif "radius" in columns:
        for axis in _axes_of_radius(shape):
            radii[at, axis] = columns["radius"]


def _axes_of_radius(shape: Shape) -> list[int]:
    """The axes that a shape's one `radius` scales: those whose squares its f has."""
    return [axis for axis, square in enumerate(shape.squares) if square and (axis < 2 or shape.radii != 2)]


def _set_placements(placements: Floats, at: slice | NDArray[np.int64], columns: dict[str, Any]) -> None:
    """Write world_from_object into rows of (n, 3, 4)."""
    if "transform" in columns:
        placements[at] = columns["transform"][:, :3]
        return
    placed = placements[at]  # a copy where `at` has gaps
    center, rotation = columns.get("center"), columns.get("rotation")
    for start in range(0, len(placed), _BLOCK):
        block = slice(start, start + _BLOCK)
        placed[block, :, :3] = np.eye(3) if rotation is None else rotation_matrices(rotation[block])
        placed[block, :, 3] = 0.0 if center is None else center[block]
    if not isinstance(at, slice):
        placements[at] = placed


def rotation_matrices(quaternions: Floats) -> Floats:
    """(n, 4) quaternions [x, y, z, w] of any length but 0 to (n, 3, 3) rotations.

    A fixed sequence of binary64 operations, each correctly rounded, in the order written here and in docs/scene.md.
    The quaternion is first scaled by the power of two that brings its largest component into [1/2, 1), so that nothing
    overflows or is lost; products are divided by its squared length, so that no square root is needed and turns by
    multiples of 90 degrees come out exact.
    """
    x, y, z, w = _scaled(quaternions)
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    xy, xz, yz, xw, yw, zw = x * y, x * z, y * z, x * w, y * w, z * w
    length2 = (xx + yy) + (zz + ww)
    rows = [
        [((xx + ww) - (yy + zz)) / ((xx + ww) + (yy + zz)), 2 * (xy - zw) / length2, 2 * (xz + yw) / length2],
        [2 * (xy + zw) / length2, ((yy + ww) - (xx + zz)) / ((yy + ww) + (xx + zz)), 2 * (yz - xw) / length2],
        [2 * (xz - yw) / length2, 2 * (yz + xw) / length2, ((zz + ww) - (xx + yy)) / ((zz + ww) + (xx + yy))],
    ]
    return np.array(rows).transpose(2, 0, 1) + 0.0


def _scaled(quaternions: Floats) -> Floats:
    """(4, n) components times the power of two that brings the largest into [1/2, 1)."""
    components: Floats = np.ascontiguousarray(quaternions.T)
    exponent = np.frexp(np.abs(components).max(axis=0))[1]
    # In two factors, because 2^1074, which the smallest numbers need, is none.
    first = np.minimum(-exponent, 1023)
    components = components * np.ldexp(1.0, first)
    return components if (first == -exponent).all() else components * np.ldexp(1.0, -exponent - first)


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
    if len(given) < 2:  # already in order
        return next((clip.rows for _, clip in given), np.zeros((0, 4))), start
    owners = np.concatenate([np.repeat(index, clip.counts) for index, clip in given])
    rows = np.concatenate([clip.rows for _, clip in given])
    return rows[np.argsort(owners, kind="stable")], start


def resolve_output(columns: dict[str, Any]) -> Output:
    """The output of a document's one `output` object, given as columns of length 1."""
    lists = {key: column.tolist() if isinstance(column, np.ndarray) else column for key, column in columns.items()}
    return Output(**{key: values[0] for key, values in lists.items()})
