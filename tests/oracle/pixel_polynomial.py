"""Integer polynomials in the doubled pixel coordinates (i', j') = (2i + 1, 2j + 1).

Doubling makes pixel centres integers: u = i'/2, v = j'/2.
"""

from collections.abc import Sequence
from typing import NamedTuple

from flint import fmpq, fmpq_mat, fmpz


class Linear(NamedTuple):
    """x·i' + y·j' + one."""

    x: fmpz
    y: fmpz
    one: fmpz

    def at(self, i: int, j: int) -> fmpz:
        return self.x * i + self.y * j + self.one

    def spread(self, i: int, j: int, half: int) -> fmpz:
        """Sum of the magnitudes of the terms about (i', j') at distance `half`."""
        return abs(self.at(i, j)) + half * (abs(self.x) + abs(self.y))


class Quadratic(NamedTuple):
    """xx·i'² + xy·i'j' + yy·j'² + x·i' + y·j' + one."""

    xx: fmpz
    xy: fmpz
    yy: fmpz
    x: fmpz
    y: fmpz
    one: fmpz

    def at(self, i: int, j: int) -> fmpz:
        return (self.xx * i + self.xy * j + self.x) * i + (self.yy * j + self.y) * j + self.one

    def spread(self, i: int, j: int, half: int) -> fmpz:
        """Sum of the magnitudes of the terms about (i', j') at distance `half`: its Taylor terms, in absolute value."""
        slope_x = 2 * self.xx * i + self.xy * j + self.x
        slope_y = 2 * self.yy * j + self.xy * i + self.y
        curvature = abs(self.xx) + abs(self.xy) + abs(self.yy)
        return abs(self.at(i, j)) + half * (abs(slope_x) + abs(slope_y)) + half * half * curvature

    def minus(self, other: "Quadratic", factor: fmpz) -> "Quadratic":
        """self - factor·other."""
        return Quadratic(*(a - factor * b for a, b in zip(self, other, strict=True)))


def squared(line: Linear) -> Quadratic:
    """The square of a linear polynomial."""
    x, y, one = line
    return Quadratic(x * x, 2 * x * y, y * y, 2 * x * one, 2 * y * one, one * one)


def times(first: Linear, second: Linear) -> Quadratic:
    """The product of two linear polynomials."""
    (a, b, c), (d, e, f) = first, second
    return Quadratic(a * d, a * e + b * d, b * e, a * f + c * d, b * f + c * e, c * f)


def integers(values: Sequence[fmpq]) -> tuple[list[fmpz], fmpz]:
    """Numerators over one positive common denominator, and that denominator."""
    scale = fmpz(1)
    for value in values:
        scale = scale.lcm(value.q)
    return [value.p * (scale // value.q) for value in values], scale


def quadratic_terms(form: fmpq_mat) -> list[fmpq]:
    """Coefficients, in `Quadratic`'s order, of pᵀFp with p = (i', j', 1) and any 3×3 F."""
    f = form.tolist()
    return [f[0][0], f[0][1] + f[1][0], f[1][1], f[0][2] + f[2][0], f[1][2] + f[2][1], f[2][2]]
