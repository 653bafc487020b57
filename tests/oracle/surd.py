"""Exact numbers (r + k√s)/m: what a ray's hits on a quadric are, and every decision about them.

All parts are integers, so the sign of any combination is decided by squaring, without rounding.
"""

from typing import NamedTuple

from flint import arb, ctx, fmpz

FILTER_BITS = 96


class Surd(NamedTuple):
    """(r + k√s)/m with s >= 0 and m > 0."""

    r: fmpz
    k: fmpz
    s: fmpz
    m: fmpz

    def enclosure(self, bits: int) -> arb:
        """Ball around the number, computed with `bits` bits; it may be relatively wide where r and k√s cancel."""
        with ctx.workprec(bits):
            if not self.k or not self.s:
                return arb(self.r) / self.m
            return (self.r + self.k * arb(self.s).sqrt()) / self.m


def sign(x: fmpz) -> int:
    """-1, 0 or 1."""
    return int(x > 0) - int(x < 0)


def sign_of_sum(a: fmpz, b: fmpz, s: fmpz) -> int:
    """Sign of a + b√s, s >= 0."""
    sign_a = sign(a)
    sign_b = sign(b) if s else 0
    if sign_a == sign_b or not sign_b:
        return sign_a
    if not sign_a:
        return sign_b
    return sign_a * sign(a * a - b * b * s)


def sign_of_linear(e: fmpz, g: fmpz, x: Surd) -> int:
    """Sign of e + g·x."""
    return sign_of_sum(e * x.m + g * x.r, g * x.k, x.s)


def compare(x: Surd, y: Surd) -> int:
    """Sign of x - y; balls first, squaring where they overlap."""
    ball_x, ball_y = x.enclosure(FILTER_BITS), y.enclosure(FILTER_BITS)
    if ball_x < ball_y:
        return -1
    if ball_x > ball_y:
        return 1
    a, b, c = x.r * y.m - y.r * x.m, x.k * y.m, -y.k * x.m
    if x.s == y.s:
        return sign_of_sum(a, b + c, x.s)
    left = sign_of_sum(a, b, x.s)
    right = sign(c) if y.s else 0
    if left == right or not right:
        return left
    if not left:
        return right
    # |a + b√s| against |c√s'|: the difference of their squares is again of the form a + b√s.
    return left * sign_of_sum(a * a + b * b * x.s - c * c * y.s, 2 * a * b, x.s)
