"""Numbers one square root away from the rationals: signs and order by squaring, never by approximation."""

from typing import NamedTuple

from flint import arb, fmpq, fmpz

from conicoid.exact.rationals import sign


class Surd(NamedTuple):
    """The number (p + k sqrt(s))/q with integers s >= 0, q > 0."""

    p: fmpz
    k: fmpz
    s: fmpz
    q: fmpz

    def enclosed(self) -> arb:
        """A ball around it, in the working precision."""
        return (self.p + self.k * arb(self.s).sqrt()) / self.q

    def side_of(self, value: fmpq) -> int:
        """Sign of the difference from a rational."""
        return sign_of_sum(self.p * value.q - self.q * value.p, self.k * value.q, self.s)

    def along(self, offset: fmpz, slope: fmpz, weight: fmpz) -> "Surd":
        """(offset + slope times this)/weight, with weight > 0."""
        return Surd(offset * self.q + slope * self.p, slope * self.k, self.s, weight * self.q)

    def sign(self) -> int:
        """-1, 0 or 1."""
        return sign_of_sum(self.p, self.k, self.s)


class SurdOverRoot(NamedTuple):
    """The number x / sqrt(y) with x = p + k sqrt(s) and y = m + n sqrt(s) > 0, all integers."""

    p: fmpz
    k: fmpz
    m: fmpz
    n: fmpz
    s: fmpz

    def enclosed(self) -> arb:
        """A ball around it, in the working precision; not finite where that cannot tell y from 0."""
        root = arb(self.s).sqrt()
        return (self.p + self.k * root) / (self.m + self.n * root).sqrt()

    def side_of(self, value: fmpq) -> int:
        """Sign of the difference from a rational: that of x^2 - value^2 y where both have one sign."""
        own, other = sign_of_sum(self.p, self.k, self.s), sign(value)
        if own != other or own == 0:
            return (own > other) - (own < other)
        over, under = value.p * value.p, value.q * value.q
        rational = (self.p * self.p + self.k * self.k * self.s) * under - over * self.m
        return own * sign_of_sum(rational, 2 * self.p * self.k * under - over * self.n, self.s)


def sign_of_sum(p: fmpz, k: fmpz, s: fmpz) -> int:
    """Sign of p + k sqrt(s), s >= 0."""
    first, second = sign(p), sign(k) if s else 0
    if second in (0, first):
        return first
    if first == 0:
        return second
    return first * sign(p * p - k * k * s)


def compare(first: Surd, second: Surd) -> int:
    """Sign of first - second."""
    p = first.p * second.q - second.p * first.q
    k, m = first.k * second.q, -second.k * first.q
    if not (m and second.s):
        return sign_of_sum(p, k, first.s)
    if not (k and first.s):
        return sign_of_sum(p, m, second.s)
    # p + (k sqrt(s) + m sqrt(t)): the bracket by its squares, then the sum by its own.
    s, t = first.s, second.s
    left, right = k * k * s, m * m * t
    bracket = sign(k) if sign(k) == sign(m) else sign(k) * sign(left - right)
    own = sign(p)
    if bracket in (0, own):
        return own
    if own == 0:
        return bracket
    return own * sign_of_sum(p * p - left - right, -2 * k * m, s * t)
