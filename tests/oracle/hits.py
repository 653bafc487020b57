"""Where one ray meets one quadric: roots and cap points, and which of them are kept (contract, section 1.3)."""

from functools import cmp_to_key
from typing import NamedTuple

from flint import fmpz

from tests.oracle.exact_quadric import ExactQuadric, HalfSpace
from tests.oracle.surd import Surd, compare, sign, sign_of_linear

SURFACE, CAP_Z0, CAP_Z1 = 0, 1, 2


class RayForm(NamedTuple):
    """A t² + 2B t + C = 0 on one ray, with S = B² - A·C."""

    a: fmpz
    b: fmpz
    c: fmpz
    s: fmpz


class Hit(NamedTuple):
    """One crossing of a ray with a quadric's surface or cap plane.

    Attributes:
        kind: SURFACE, CAP_Z0 or CAP_Z1.
        t: planar depth.
        slope: sign of n·d with n the outward normal (∇f, or -z and +z on the caps).
    """

    kind: int
    t: Surd
    slope: int


def ray_form(quadric: ExactQuadric, i: int, j: int) -> RayForm:
    """The quadratic of the ray through doubled pixel coordinates (i, j)."""
    a, b, c = quadric.a.at(i, j), quadric.b.at(i, j), quadric.c.at(i, j)
    return RayForm(a, b, c, b * b - a * c)


def crossings(quadric: ExactQuadric, form: RayForm, i: int, j: int) -> list[Hit]:
    """Every point where the ray meets the unbounded surface or lies on a cap's disc, in no order, t of any sign."""
    return [*surface_roots(form), *(hit for hit in cap_points(quadric, i, j) if on_disc(form, hit.t))]


def surface_roots(form: RayForm) -> list[Hit]:
    """Roots in ascending order; none where the ray lies in the surface, one where it is tangent."""
    a, b, c, s = form
    if not a:
        return [Hit(SURFACE, Surd(-c * sign(b), fmpz(0), fmpz(0), 2 * abs(b)), sign(b))] if b else []
    if s < 0:
        return []
    up = sign(a)
    if not s:
        return [Hit(SURFACE, Surd(-b * up, fmpz(0), s, abs(a)), 0)]
    # At (-b ± √s)/a the derivative a·t + b is ±√s.
    return [Hit(SURFACE, Surd(-b * up, fmpz(side), s, abs(a)), side * up) for side in (-1, 1)]


def cap_points(quadric: ExactQuadric, i: int, j: int) -> list[Hit]:
    """Where the ray crosses the cap planes; none for a ray within or beside such a plane."""
    points = []
    for cap in quadric.caps:
        e, g = cap.e.at(i, j), cap.g.at(i, j)
        if g:
            outward = -1 if cap.kind == CAP_Z0 else 1
            points.append(Hit(cap.kind, Surd(-e * sign(g), fmpz(0), fmpz(0), abs(g)), outward * sign(g)))
    return points


def on_disc(form: RayForm, t: Surd) -> bool:
    """Whether f <= 0 at a rational t."""
    return form.a * t.r * t.r + 2 * form.b * t.r * t.m + form.c * t.m * t.m <= 0


def within(bounds: list[HalfSpace], t: Surd, i: int, j: int) -> bool:
    """Whether all the closed half-spaces hold at t."""
    return all(sign_of_linear(bound.e.at(i, j), bound.g.at(i, j), t) >= 0 for bound in bounds)


def is_kept(quadric: ExactQuadric, hit: Hit, i: int, j: int) -> bool:
    """Whether a crossing is in front of the camera and inside near, far, clips and, for the surface, z_range."""
    return (
        sign_of_linear(fmpz(0), fmpz(1), hit.t) > 0
        and within(quadric.always, hit.t, i, j)
        and (hit.kind != SURFACE or within(quadric.extent, hit.t, i, j))
    )


def kept_hits(quadric: ExactQuadric, form: RayForm, i: int, j: int) -> list[Hit]:
    """Kept hits, nearest first; equal t in the order surface, cap at z0, cap at z1."""
    kept = [hit for hit in crossings(quadric, form, i, j) if is_kept(quadric, hit, i, j)]
    return sorted(kept, key=cmp_to_key(_in_order))


def _in_order(first: Hit, second: Hit) -> int:
    return compare(first.t, second.t) or first.kind - second.kind
