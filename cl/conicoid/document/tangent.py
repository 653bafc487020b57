"""tan of half an angle in degrees, correctly rounded: the one transcendental function of a scene."""

from threading import Lock
from typing import Final

from flint import arb, ctx

_FIRST_BITS: Final = 96
_PRECISION: Final = Lock()  # flint's working precision is one setting for the whole process


def tan_half(degrees: float) -> float:
    """The binary64 nearest to tan(degrees * pi / 360), for 0 < degrees < 180; may round to 0.

    Ziv's method: more bits until both ends of the enclosure round alike. It ends, because the tangent of a rational
    multiple of pi is 0, +-1 or irrational (Niven), so it is never halfway between two binary64 numbers.
    """
    bits = _FIRST_BITS
    while True:
        with _PRECISION, ctx.workprec(bits):
            enclosure = (arb(degrees) / 360).tan_pi()
            low, high = _nearest(enclosure.lower()), _nearest(enclosure.upper())
        if low == high:
            return low
        bits *= 2


def _nearest(exact: arb) -> float:
    """An exact binary number as the nearest binary64: Python divides integers with correct rounding."""
    mantissa, exponent = (int(part) for part in exact.man_exp())
    return (mantissa << max(exponent, 0)) / (1 << max(-exponent, 0))
