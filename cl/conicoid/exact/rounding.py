"""Correct rounding of real numbers to binary32 (Ziv's method: a finer enclosure until one float is left)."""

import math
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
    precision, before = _FIRST_PRECISION, ctx.prec
    try:
        while True:
            ctx.prec = precision
            ball = number.enclosed()
            if ball.is_finite():
                low, high = _ordinal(ball.lower()), _ordinal(ball.upper())
                if low == high:
                    return _value(low)
                if high == low + 1:
                    break
            precision *= 2
    finally:
        ctx.prec = before
    side = number.side_of((_exact_value(low) + _exact_value(high)) / 2)
    return _value(high if side > 0 or (side == 0 and high % 2 == 0) else low)


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


def _ordinal(point: arb) -> int:
    """Place of the nearest binary32 value in their order, 0 for zero, one per value; infinity stands for 2^128."""
    mantissa, exponent = (int(part) for part in point.man_exp())
    size = abs(mantissa)
    # The nearest value is a multiple of 2^(exponent + drop): 24 bits, or fewer below the normal range.
    drop = max(size.bit_length() - 24, -149 - exponent)
    if drop > 0:
        kept, half = size >> drop, 1 << (drop - 1)
        rest = size - (kept << drop)
        kept += rest > half or (rest == half and kept % 2 == 1)
    else:
        kept = size << -drop
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
