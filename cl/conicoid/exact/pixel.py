"""What one hit pixel shows: every channel as the exact value, rounded once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import frexp, inf, isfinite
from typing import Final

from flint import fmpz

from conicoid.exact.hits import Hit
from conicoid.exact.quadric import SURFACE, ExactQuadric
from conicoid.exact.rays import ExactRays
from conicoid.exact.rounding import distance, nearest_float32, nearest_multiple
from conicoid.exact.surd import Surd, SurdOverRoot

Vector = tuple[float, float, float]

# As an exponent of two; kernels/certify.h.
_NORMAL_STEP: Final = -23
_SMALLEST: Final = 2.0**-100


@dataclass(frozen=True)
class ExactPixel:
    """The winner at one pixel.

    Depths are the exact values rounded to the nearest binary32: ties to even, gradual underflow, overflow to infinity.
    Components of vectors are rounded alike to multiples of one step, ties to even: 2^-23 for normals, and for positions
    the unit in the last place of the largest component once that is rounded to binary32. Nothing is ever -0, and each
    is computed when first asked for.

    Attributes:
        quadric: index of the winner in the scene.
        kind: SURFACE, CAP_LOW or CAP_HIGH, which part of it is hit.
    """

    quadric: int
    kind: int
    _rays: ExactRays
    _exact: ExactQuadric
    _outward: bool
    _first: Hit
    _last: Hit
    _u: fmpz
    _v: fmpz

    @cached_property
    def z(self) -> float:
        """Planar depth t."""
        return nearest_float32(self._first.t)

    @cached_property
    def z_back(self) -> float:
        """Planar depth of the last kept hit of the same quadric."""
        return self.z if self._last is self._first else nearest_float32(self._last.t)

    @cached_property
    def t(self) -> float:
        """Distance along the ray: t |d|, d in camera axes."""
        t = self._first.t
        x, y, z = (row.at(self._u, self._v)[1] for row in self._rays.direction)
        # d is (x, y, z)/|z|, so t |d| = t (x^2 + y^2 + z^2) / sqrt((x^2 + y^2 + z^2) z^2).
        length = x * x + y * y + z * z
        return nearest_float32(SurdOverRoot(t.p * length, t.k * length, length * (z * t.q) ** 2, fmpz(0), t.s))

    @cached_property
    def position(self) -> Vector:
        """World coordinates of the hit."""
        largest = max(abs(nearest_float32(axis)) for axis in self._position)
        if not _SMALLEST <= largest < inf:
            x, y, z = map(nearest_float32, self._position)
        else:
            step = frexp(largest)[1] - 24
            x, y, z = (nearest_multiple(axis, step) for axis in self._position)
        return x, y, z

    @cached_property
    def normal(self) -> Vector:
        """Unit normal in the output's space and on its side; back along the ray where the gradient vanishes."""
        x, y, z = (nearest_multiple(axis, _NORMAL_STEP) for axis in self._normal)
        return x, y, z

    def position_errors(self, position: Sequence[float]) -> list[float]:
        """How far x, y, z are from the exact ones, which infinities beyond binary32 stand for."""
        return [_error(*pair) for pair in zip(position, self._position, self.position, strict=True)]

    def normal_errors(self, normal: Sequence[float]) -> list[float]:
        """How far x, y, z are from the exact ones."""
        return [_error(*pair) for pair in zip(normal, self._normal, self.normal, strict=True)]

    @cached_property
    def _position(self) -> list[Surd]:
        *axes, weight = (row.at(self._u, self._v) for row in self._rays.position)
        return [self._first.t.along(*axis, weight[0]) for axis in axes]

    @cached_property
    def _normal(self) -> list[SurdOverRoot]:
        t, turn = self._first.t, -1 if self._first.facing > 0 and not self._outward else 1
        if self.kind == SURFACE:
            gradient = [t.along(*row.at(self._u, self._v), fmpz(1)) for row in self._exact.gradient]
        else:
            gradient = [Surd(axis, fmpz(0), fmpz(0), fmpz(1)) for axis in self._exact.cap_normal(self.kind)]
        if not any(axis.sign() for axis in gradient):
            ahead = (row.at(self._u, self._v)[1] for row in self._rays.target)
            gradient, turn = [Surd(axis, fmpz(0), fmpz(0), fmpz(1)) for axis in ahead], -1
        # The components share q and s: q cancels, and the length squared stays in the same field.
        s = gradient[0].s
        m = sum((axis.p * axis.p + axis.k * axis.k * s for axis in gradient), fmpz(0))
        n = sum((2 * axis.p * axis.k for axis in gradient), fmpz(0))
        return [SurdOverRoot(turn * axis.p, turn * axis.k, m, n, s) for axis in gradient]


def _error(value: float, number: Surd | SurdOverRoot, rounded: float) -> float:
    if isfinite(value):
        return distance(value, number)
    return 0.0 if value == rounded else inf
