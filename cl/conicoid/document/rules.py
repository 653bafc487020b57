"""Rules on whole vectors and matrices, beyond the bounds of their entries: the same test for one and for a million."""

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.document.determinant import determinant_sign
from conicoid.document.problems import show, show_numbers
from conicoid.scene import Floats


@dataclass(frozen=True)
class Rule:
    """What every value of a numeric column satisfies.

    Attributes:
        holds: (n, ...) finite values to (n,) bool.
        message: for the JSON value of one that does not hold: value, rule and remedy.
        within: place of the fault within the value, as in `[3]` for the last row of a matrix.
        schema: what JSON Schema can say of the rule.
        code: of the problem.
    """

    holds: Callable[[NDArray[Any]], NDArray[np.bool_]]
    message: Callable[[Any], str]
    within: str = ""
    schema: dict[str, Any] = field(default_factory=dict)
    code: str = "scene-value"


def _nonzero(values: Floats) -> NDArray[np.bool_]:
    some: NDArray[np.bool_] = (values != 0).reshape(len(values), -1).any(axis=1)
    return some


def rigid(matrices: Floats) -> NDArray[np.bool_]:
    """Whether the rotation part R of each (n, 4, 4) has max|R^T R - I| <= 1e-6 and det R > 0, exactly."""
    linear = matrices[:, :3, :3]
    return np.array([_nearly_orthonormal(matrix) for matrix in linear], dtype=bool) & (determinant_sign(linear) > 0)


def _nearly_orthonormal(matrix: Floats) -> bool:
    columns = [[Fraction(entry) for entry in column] for column in matrix.T.tolist()]
    products = (
        sum((p * q for p, q in zip(columns[i], columns[j], strict=True)), Fraction(-1 if i == j else 0))
        for i in range(3)
        for j in range(i, 3)
    )
    return all(abs(product) <= Fraction(1, 10**6) for product in products)


def _asymmetry(matrix: list[list[float]]) -> str:
    i, j = next((i, j) for i in range(4) for j in range(i) if matrix[i][j] != matrix[j][i])
    return (
        f"not symmetric: entry [{j}][{i}] is {show(matrix[j][i])}, entry [{i}][{j}] is {show(matrix[i][j])}; "
        "give both halves alike, each the half of its coefficient in f"
    )


_SOME_NONZERO: Final = {"contains": {"type": "number", "not": {"const": 0}}}
NONZERO_QUATERNION: Final = Rule(
    _nonzero,
    lambda _: "all zero is not a rotation; give a quaternion [x, y, z, w] other than zero, of any length",
    schema=_SOME_NONZERO,
)
NONZERO_DIRECTION: Final = Rule(
    _nonzero,
    lambda _: "all zero is not a direction; give a vector [x, y, z] other than zero, of any length",
    schema=_SOME_NONZERO,
)
NONZERO_COEFFICIENTS: Final = Rule(
    _nonzero,
    lambda _: "all zero is not a surface; give at least one coefficient other than zero",
    schema=_SOME_NONZERO,
)
NONZERO_FORM: Final = Rule(_nonzero, lambda _: "all zero is not a surface; give at least one entry other than zero")
SYMMETRIC: Final = Rule(lambda matrices: (matrices == matrices.transpose(0, 2, 1)).all(axis=(1, 2)), _asymmetry)
AFFINE: Final = Rule(
    lambda matrices: (matrices[:, 3] == (0, 0, 0, 1)).all(axis=1),
    lambda matrix: (
        f"{show_numbers(matrix[3])} is not [0, 0, 0, 1]; give an affine matrix in rows, the translation last in each"
    ),
    within="[3]",
    schema={"allOf": [{"prefixItems": [{}, {}, {}, {"const": [0, 0, 0, 1]}]}]},
)
INVERTIBLE: Final = Rule(
    lambda matrices: determinant_sign(matrices[:, :3, :3]) != 0,
    lambda _: "singular: its determinant is exactly 0; give a transform that does not flatten space",
)
VERSION: Final = Rule(
    lambda versions: versions == 1,
    lambda version: f"version {show(version)} of the format is not read by this version; give 1",
    schema={"const": 1},
    code="scene-unsupported",
)
RIGID: Final = Rule(
    rigid,
    lambda _: (
        "its upper left 3x3 part R is not a rotation: max|R^T R - I| <= 1e-6 and det R > 0 must hold; "
        "give a pose without scale, shear or reflection"
    ),
)
ASCENDING: Final = Rule(
    lambda ranges: ranges[:, 0] <= ranges[:, 1],
    lambda ends: f"{show_numbers(ends)} runs backwards; give [z0, z1] with z0 <= z1",
)
CROP: Final = Rule(
    lambda crops: (crops[:, 0] < crops[:, 2]) & (crops[:, 1] < crops[:, 3]),
    lambda crop: f"{show_numbers(crop)} is empty; give [x0, y0, x1, y1] with x0 < x1 and y0 < y1",
)
