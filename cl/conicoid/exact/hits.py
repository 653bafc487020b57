"""Where one ray meets one quadric, and which of these points are kept."""

from collections.abc import Iterable, Iterator
from typing import Final, NamedTuple

from flint import fmpq, fmpz

from conicoid.exact.quadric import CAP_HIGH, CAP_LOW, SURFACE, ExactQuadric
from conicoid.exact.rationals import sign
from conicoid.exact.rays import AlongRays
from conicoid.exact.surd import Surd, sign_of_sum

_ZERO: Final = fmpz(0)


class Hit(NamedTuple):
    """A point where the ray meets the surface or a cap.

    Attributes:
        kind: SURFACE, CAP_LOW or CAP_HIGH.
        t: its planar depth.
        facing: sign of the outward normal (+ gradient) times the ray's direction; 0 where the ray only touches.
    """

    kind: int
    t: Surd
    facing: int


class Depths(NamedTuple):
    """near <= t <= far (None: no end), and always t > 0."""

    near: fmpq
    far: fmpq | None

    def keep(self, t: Surd) -> bool:
        """Whether a depth is within."""
        return t.sign() > 0 and t.side_of(self.near) >= 0 and (self.far is None or t.side_of(self.far) <= 0)


def kept_hits(quadric: ExactQuadric, depths: Depths, u: fmpz, v: fmpz) -> list[Hit]:
    """Every kept hit of the ray through doubled pixel coordinates (u, v); the surface's come first."""
    a, b, c = quadric.a.at(u, v), quadric.b.at(u, v), quadric.c.at(u, v)
    kept = [
        hit
        for hit in _surface(a, b, c)
        if depths.keep(hit.t) and _inside(quadric.range, hit.t, u, v) and _inside(quadric.clips, hit.t, u, v)
    ]
    if quadric.capped:
        caps = zip((CAP_LOW, CAP_HIGH), quadric.range, strict=True)
        discs = (_cap(kind, *end.at(u, v), a, b, c) for kind, end in caps)
        kept += [hit for hit in discs if hit and depths.keep(hit.t) and _inside(quadric.clips, hit.t, u, v)]
    return kept


def _surface(a: fmpz, b: fmpz, c: fmpz) -> Iterator[Hit]:
    """Roots of a t^2 + 2b t + c, ascending; a double root once, and none where all three vanish.

    There f's slope along the ray, a t + b, is the root's own signed square root of b^2 - ac.
    """
    if not a:
        if b:
            yield Hit(SURFACE, _ratio(-c, 2 * b), sign(b))
        return
    square = b * b - a * c
    if square < 0:
        return
    if not square:
        yield Hit(SURFACE, _ratio(-b, a), 0)
        return
    rising = sign(a)
    for side in (-1, 1):
        yield Hit(SURFACE, Surd(-b * rising, fmpz(side), square, a * rising), rising * side)


def _cap(kind: int, offset: fmpz, slope: fmpz, a: fmpz, b: fmpz, c: fmpz) -> Hit | None:
    """Where the ray meets the plane that ends the half-space offset + slope t >= 0, if f <= 0 there."""
    if not slope or a * offset * offset - 2 * b * offset * slope + c * slope * slope > 0:
        return None
    return Hit(kind, _ratio(-offset, slope), -sign(slope))


def _ratio(numerator: fmpz, denominator: fmpz) -> Surd:
    side = sign(denominator)
    return Surd(numerator * side, _ZERO, _ZERO, denominator * side)


def _inside(half_spaces: Iterable[AlongRays], t: Surd, u: fmpz, v: fmpz) -> bool:
    for half_space in half_spaces:
        offset, slope = half_space.at(u, v)
        if sign_of_sum(offset * t.q + slope * t.p, slope * t.k, t.s) < 0:
            return False
    return True
