"""Correct rounding of real numbers (Ziv's method: a finer enclosure until one result is left)."""

import math
from collections.abc import Callable
from typing import Final, Protocol

from flint import arb, ctx, fmpq

_FIRST_PRECISION: Final = 128
_INFINITY: Final = 0x7F800000


class Real(Protocol):
    """A real number that can be enclosed as closely as wanted and compared with rationals."""

    def enclosed(self) -> arb:
        """A ball around it, in the working precision; it shrinks to the number as that grows."""

    def side_of(self, value: fmpq, /) -> int:
        """Sign of the difference from a rational, exactly."""


def nearest_float32(number: Real) -> float:
    """The binary32 value nearest to a number: ties to even, gradual underflow, overflow to infinity, never -0.

    The enclosure is refined until at most one rounding boundary is inside; the exact comparison then decides.
    """
    low, high = _enclosed(number, _ordinal)
    if low == high:
        return _value(low)
    side = number.side_of((_exact_value(low) + _exact_value(high)) / 2)
    return _value(high if side > 0 or (side == 0 and high % 2 == 0) else low)


def nearest_multiple(number: Real, exponent: int) -> float:
    """The multiple of 2^exponent nearest to a number, ties to even, never -0; binary64 must hold it."""
    low, high = _enclosed(number, lambda point: _nearest_whole(point, exponent))
    if low != high:
        side = number.side_of(fmpq(low + high, 2) * fmpq(2) ** exponent)
        low = high if side > 0 or (side == 0 and high % 2 == 0) else low
    return math.ldexp(low, exponent)


def _enclosed(number: Real, place: Callable[[arb], int]) -> tuple[int, int]:
    """Places of a number by a monotonic rounding to whole numbers: equal, or two that follow each other."""
    precision, before = _FIRST_PRECISION, ctx.prec
    try:
        while True:
            ctx.prec = precision
            ball = number.enclosed()
            if ball.is_finite():
                low, high = place(ball.lower()), place(ball.upper())
                if high - low <= 1:
                    return low, high
            precision *= 2
    finally:
        ctx.prec = before


def distance(value: float, number: Real) -> float:
    """|value - number| to some nine digits of it, or of |value| 2^-60 where that is more."""
    precision, before = _FIRST_PRECISION, ctx.prec
    try:
        while True:
            ctx.prec = precision
            ball = abs(number.enclosed() - arb(value))
            if ball.is_finite() and ball.rad() <= max(float(ball.mid()) * 2.0**-30, abs(value) * 2.0**-60, 2.0**-200):
                return float(ball.mid())
            precision *= 2
    finally:
        ctx.prec = before


def _nearest_whole(point: arb, exponent: int) -> int:
    """The whole number nearest to point / 2^exponent, ties to even."""
    mantissa, shift = (int(part) for part in point.man_exp())
    shift -= exponent
    return mantissa << shift if shift >= 0 else _halved(mantissa, -shift)


def _halved(whole: int, times: int) -> int:
    """A whole number over 2^times, to the nearest, ties to even."""
    kept, half = whole >> times, 1 << (times - 1)
    rest = whole - (kept << times)
    return kept + (rest > half or (rest == half and kept % 2 == 1))


def _ordinal(point: arb) -> int:
    """Place of the nearest binary32 value in their order, 0 for zero, one per value; infinity stands for 2^128."""
    mantissa, exponent = (int(part) for part in point.man_exp())
    size = abs(mantissa)
    # The nearest value is a multiple of 2^(exponent + drop): 24 bits, or fewer below the normal range.
    drop = max(size.bit_length() - 24, -149 - exponent)
    kept = _halved(size, drop) if drop > 0 else size << -drop
    if kept == 0:
        return 0
    ordinal = min(kept + ((exponent + drop + 149) << 23), _INFINITY)
    return ordinal if mantissa > 0 else -ordinal


def _parts(ordinal: int) -> tuple[int, int]:
    """Mantissa and exponent of a binary32 value by its place; 2^128 for infinity."""
    size = abs(ordinal)
    field, fraction = size >> 23, size & 0x7FFFFF
    mantissa = fraction + 0x800000 if field else fraction
    return (mantissa if ordinal > 0 else -mantissa), max(field, 1) - 150


def _exact_value(ordinal: int) -> fmpq:
    mantissa, exponent = _parts(ordinal)
    return fmpq(mantissa) * fmpq(2) ** exponent


def _value(ordinal: int) -> float:
    if abs(ordinal) == _INFINITY:
        return math.copysign(math.inf, ordinal)
    return math.ldexp(*_parts(ordinal))
