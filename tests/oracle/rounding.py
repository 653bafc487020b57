"""From exact numbers to floating point: correctly rounded, or close enough with a proof."""

from collections.abc import Callable

import numpy as np
from flint import arb, ctx, fmpq

START_BITS = 224
OVERFLOW = fmpq(2**128)


def exact(value: float) -> fmpq:
    """The rational that a finite binary64 is."""
    return fmpq(*float(value).as_integer_ratio())


def nearest_float32(value: fmpq) -> np.float32:
    """Nearest-even float32 of a rational; inf from 2^128 - 2^103 on, subnormals included."""
    numerator, denominator = int(abs(value).p), int(value.q)
    if not numerator:
        return np.float32(0)
    # 2^(exponent) <= |value| < 2^(exponent + 2); the second guess settles which.
    exponent = numerator.bit_length() - denominator.bit_length() - 1
    if fmpq(2) ** (exponent + 1) <= abs(value):
        exponent += 1
    quantum = max(exponent, -126) - 23
    if quantum >= 0:
        denominator <<= quantum
    else:
        numerator <<= -quantum
    steps, rest = divmod(numerator, denominator)
    if 2 * rest > denominator or (2 * rest == denominator and steps % 2):
        steps += 1
    magnitude = float("inf") if steps.bit_length() + quantum > 128 else float(steps) * 2.0**quantum
    return np.float32(magnitude if value > 0 else -magnitude)


def rounded_float32(enclose: Callable[[int], arb], equals: Callable[[fmpq], bool]) -> np.float32:
    """Nearest-even float32 of a number that can be enclosed to any precision (Ziv's method).

    Args:
        enclose: ball around the number, computed with a given number of bits.
        equals: whether the number is exactly this rational; asked only at midpoints of neighbouring float32.
    """
    bits = START_BITS
    while True:
        ball = enclose(bits)
        if ball.is_finite():
            with ctx.workprec(bits):
                low, high = _rational(ball.lower()), _rational(ball.upper())
            below, above = nearest_float32(low), nearest_float32(high)
            if below == above:
                return below
            midpoint = (_as_rational(below) + _as_rational(above)) / 2
            if equals(midpoint):
                return nearest_float32(midpoint)
        bits *= 2


def closest_float(enclose: Callable[[int], arb], scale: Callable[[int], arb] | None = None) -> float:
    """A binary64 within 2^-52 of the number, relative to itself or to `scale` where that is given."""
    bits = START_BITS
    while True:
        ball = enclose(bits)
        if ball.is_finite():
            with ctx.workprec(bits):
                size = abs(ball) if scale is None else abs(scale(bits))
                if ball.rad() <= size * arb(2) ** -60:
                    return float(ball.mid())
        bits *= 2


def _rational(point: arb) -> fmpq:
    mantissa, exponent = point.man_exp()
    return fmpq(mantissa) * fmpq(2) ** int(exponent)


def _as_rational(value: np.float32) -> fmpq:
    # Beyond the largest float32 the next step would be 2^128.
    return exact(float(value)) if np.isfinite(value) else (OVERFLOW if value > 0 else -OVERFLOW)
