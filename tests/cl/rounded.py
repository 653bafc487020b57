"""Binary64 arithmetic from exact results: each operation is computed in rationals and rounded once, to nearest."""

import math
from collections.abc import Sequence
from fractions import Fraction


def nearest(exact: Fraction) -> float:
    """The nearest binary64; Python divides integers with correct rounding."""
    return exact.numerator / exact.denominator


def add(a: float, b: float) -> float:
    return nearest(Fraction(a) + Fraction(b))


def subtract(a: float, b: float) -> float:
    return nearest(Fraction(a) - Fraction(b))


def multiply(a: float, b: float) -> float:
    return nearest(Fraction(a) * Fraction(b))


def divide(a: float, b: float) -> float:
    return nearest(Fraction(a) / Fraction(b))


def root(a: float) -> float:
    """The square root, by 200 more bits than binary64 has: no root of a binary64 lies that close to a midpoint."""
    exact = Fraction(a) * 4**400
    return nearest(Fraction(math.isqrt(exact.numerator // exact.denominator), 2**400))


def scaled(vector: Sequence[float]) -> list[float]:
    """The vector times the power of two that brings its largest component into [1/2, 1)."""
    exponent = math.frexp(max(map(abs, vector)))[1]
    power = Fraction(2) ** -exponent
    return [nearest(Fraction(part) * power) for part in vector]
