"""How close a pixel is to another answer: the margins that say where binary32 may decide differently.

Every decision is the sign of a polynomial in the pixel, perhaps plus another times √S. An engine evaluates it
about the centre of a tile, with an error of a few units in the last place of the sum of its terms' magnitudes
there. So a margin is |value| over that sum, `spread`, taken about the pixel itself over `HALF_TILE` pixels, which
is at least a quarter of the sum about the centre of any tile that holds the pixel:

    about the centre, terms of order 0, 1, 2 are at most v + s + q, s + 2q, q, together v + 2s + 4q <= 4(v + s + q),

with v, s, q the pixel's own. A polynomial costs at most 6 roundings unfused, coefficient included, so binary32
errs by at most 6·4·2^-24 of `spread`, under 2^-19.4: outside `FLOAT32_BAND` = 2^-18 it decides as the exact image.

Depths are judged by `condition`: the relative error of t per relative error of the spreads, 1 for t's own rounding
included; the better of c/(-b ∓ √S) and (-b ± √S)/a counts. A unit in the last place of t is at least 2^-24·t, and
rounding the polynomials' coefficients moves a spread by up to 2^-24 of itself: so `condition` is also how many units
of depth that alone can cost. Where it is beyond 4 (beside a silhouette, at a root that goes to infinity) no evaluation
in binary32 promises 4 units. With all roundings, the depth errs by at most 24 times `condition` units.

Normals are judged the same way: c·∇f/t = (c·G₁ - b·G₀) ± √S·G₀ with ∇f = G₀ + t·G₁ (orthographic: a·∇f likewise).
"""

import math
from typing import NamedTuple

from flint import arb, ctx, fmpz

from tests.oracle.exact_quadric import ExactQuadric, HalfSpace
from tests.oracle.hits import SURFACE, Hit, RayForm, cap_points, is_kept, on_disc, surface_roots
from tests.oracle.pixel_polynomial import Linear
from tests.oracle.surd import Surd, sign_of_linear

HALF_TILE = 8
HALF = 2 * HALF_TILE  # in doubled pixels
FLOAT32_BAND = 2.0**-18
BITS = 192


class Candidate(NamedTuple):
    """A crossing, or one that a small change would create.

    Attributes:
        quadric: index.
        hit: the crossing; a ghost where S < 0, at the depth of its would-be double root.
        kept: whether the exact image keeps it.
        margin: relative change of the polynomials' spreads below which `kept` cannot change.
        condition: relative error of t per relative error of the spreads, at least 1.
    """

    quadric: int
    hit: Hit
    kept: bool
    margin: float
    condition: float


def candidates(quadric: ExactQuadric, is_pinhole: bool, form: RayForm, i: int, j: int) -> list[Candidate]:
    """All candidates of one quadric on one ray; doubled pixel coordinates."""
    with ctx.workprec(BITS):
        ray = _Ray(quadric, is_pinhole, form, i, j)
        return [*ray.surface(), *ray.caps()]


class _Ray:
    """One quadric on one ray, with the spreads of its polynomials."""

    def __init__(self, quadric: ExactQuadric, is_pinhole: bool, form: RayForm, i: int, j: int) -> None:
        self.quadric, self.is_pinhole, self.form, self.i, self.j = quadric, is_pinhole, form, i, j
        self.spread_b = quadric.linear_b.spread(i, j, HALF)
        self.spread_s = quadric.s.spread(i, j, HALF)
        varying = quadric.a if is_pinhole else quadric.c
        self.varying, self.spread_varying = varying.at(i, j), varying.spread(i, j, HALF)
        # A relative change of the spread moves √S by spread/(2√S) times it, and by no more than √spread in all.
        root, limit = arb(abs(form.s)).sqrt(), arb(self.spread_s).sqrt()
        self.root_slope = self.spread_s / (2 * root) if form.s else (arb.pos_inf() if self.spread_s else arb(0))
        self.root_change = self.root_slope if 2 * root > limit else limit

    def surface(self) -> list[Candidate]:
        a, b, _, s = self.form
        exists = _ratio(abs(s), self.spread_s) if self.spread_s else 1.0
        found = []
        for hit in surface_roots(self.form):
            kept = is_kept(self.quadric, hit, self.i, self.j)
            condition = self.condition(hit.t, self.root_slope)
            verdict = self._verdict([*self.quadric.always, *self.quadric.extent], hit)
            found.append(Candidate(self.quadric.index, hit, kept, min(exists, verdict) if kept else verdict, condition))
        if s < 0:
            ghost = Hit(SURFACE, Surd(-b if a > 0 else b, fmpz(0), fmpz(0), abs(a)), 0)
            condition = self.condition(ghost.t, self.root_slope)
            inside = is_kept(self.quadric, ghost, self.i, self.j)
            verdict = 0.0 if inside else self._verdict([*self.quadric.always, *self.quadric.extent], ghost)
            found.append(Candidate(self.quadric.index, ghost, False, max(exists, verdict), condition))
        if not a and self.is_pinhole and self.spread_varying:
            # The second root is at infinity; a small change of a brings it to a huge t of either sign.
            beyond = Hit(SURFACE, Surd(fmpz(2) ** 4096, fmpz(0), fmpz(0), fmpz(1)), 0)
            found.append(Candidate(self.quadric.index, beyond, False, self._margin_at_infinity(), 1.0))
        return found

    def caps(self) -> list[Candidate]:
        found = []
        points = {hit.kind: hit for hit in cap_points(self.quadric, self.i, self.j)}
        for cap, disc in zip(self.quadric.caps, self.quadric.discs, strict=True):
            spread = disc.spread(self.i, self.j, HALF)
            rim = _ratio(abs(disc.at(self.i, self.j)), spread) if spread else 1.0
            if cap.kind not in points:
                continue
            hit = points[cap.kind]
            line = cap.g if self.is_pinhole else cap.e
            condition = 1 + _quotient(line.spread(self.i, self.j, HALF), abs(line.at(self.i, self.j)))
            verdict = self._cap_verdict(cap.e, cap.g, hit, condition)
            inside = is_kept(self.quadric, hit, self.i, self.j)
            disc_holds = on_disc(self.form, hit.t)
            if inside and disc_holds:
                margin = min(rim, verdict)
            else:
                margin = max(0.0 if disc_holds else rim, 0.0 if inside else verdict)
            found.append(Candidate(self.quadric.index, hit, inside and disc_holds, margin, condition))
        return found

    def condition(self, t: Surd, root_change: arb) -> float:
        """1 + relative change of t per relative change of the spreads, by the better of the two formulas."""
        depth = t.enclosure(BITS)
        over_a = abs(self.form.a * depth)  # |-b ± √S| of t = (-b ± √S)/a
        change = self.spread_b + root_change
        under_c = abs(self.form.c / depth) if t.r or t.k else arb(0)  # |-b ∓ √S| of t = c/(-b ∓ √S)
        exact_form, other = (under_c, over_a) if self.is_pinhole else (over_a, under_c)
        first = _quotient(change, exact_form)
        second = _quotient(change, other) + _quotient(self.spread_varying, abs(self.varying))
        return 1 + min(first, second)

    def _verdict(self, bounds: list[HalfSpace], hit: Hit) -> float:
        """Margin of the verdict on t > 0 and the half-spaces: the weakest if all hold, the strongest that fails."""
        side = sign_of_linear(fmpz(0), fmpz(1), hit.t)
        if not side:
            # An eye on the surface: exact wherever it holds at every pixel.
            return 1.0 if self.is_pinhole or not self.spread_varying else 0.0
        condition = self.condition(hit.t, self.root_change)
        if side < 0:
            return max(1 / condition, self._margin_at_infinity()) if self.is_pinhole else 1 / condition
        i, j = self.i, self.j
        failing = [bound for bound in bounds if sign_of_linear(bound.e.at(i, j), bound.g.at(i, j), hit.t) < 0]
        if failing:
            return max(self._half_space_margin(bound, hit.t, condition) for bound in failing)
        return min([1 / condition, *(self._half_space_margin(bound, hit.t, condition) for bound in bounds)])

    def _half_space_margin(self, bound: HalfSpace, t: Surd, condition: float) -> float:
        """|e + g·t| in the polynomial form λ + μ√S that its sign is decided by, or directly where that is better."""
        e, g = bound
        depth = t.enclosure(BITS)
        e_here, g_here = e.at(self.i, self.j), g.at(self.i, self.j)
        value = abs(e_here + g_here * depth)
        terms = e.spread(self.i, self.j, HALF) + g.spread(self.i, self.j, HALF) * depth * arb(condition)
        direct = _quotient(value, terms)
        b = self.quadric.linear_b
        if self.is_pinhole:  # (e + g·t)·c/t = c·g - e·b ∓ e√S
            shared, weight = self.form.c, e_here
            line = Linear(*(shared * x - weight * y for x, y in zip(g, b, strict=True)))
            value = abs(value * shared / depth)
        else:  # (e + g·t)·a = a·e - g·b ± g√S
            shared, weight = self.form.a, g_here
            line = Linear(*(shared * x - weight * y for x, y in zip(e, b, strict=True)))
            value = abs(value * shared)
        scale = line.spread(self.i, self.j, HALF) + abs(weight) * self.root_change
        return max(direct, _quotient(value, scale) if shared else 0.0)

    def _cap_verdict(self, e: Linear, g: Linear, hit: Hit, condition: float) -> float:
        if sign_of_linear(fmpz(0), fmpz(1), hit.t) <= 0:
            return 1 / condition
        holding, failing = [1 / condition], list[float]()
        e_here, g_here = e.at(self.i, self.j), g.at(self.i, self.j)
        for bound in self.quadric.always:
            # At t = -e/g the half-space is (e'·g - g'·e)/g, linear in the pixel.
            if self.is_pinhole:
                terms = [bound.e.one * x - e.one * y for x, y in zip(g, bound.g, strict=True)]
            else:
                terms = [g.one * x - bound.g.one * y for x, y in zip(bound.e, e, strict=True)]
            line = Linear(*terms)
            margin = _quotient(abs(line.at(self.i, self.j)), line.spread(self.i, self.j, HALF))
            value = bound.e.at(self.i, self.j) * g_here - bound.g.at(self.i, self.j) * e_here
            (holding if (value >= 0) == (g_here > 0) or not value else failing).append(margin)
        return max(failing) if failing else min(holding)

    def _margin_at_infinity(self) -> float:
        """Strongest rejection of a point at t = +infinity by a half-space that ends there."""
        margins = [0.0]
        for bound in [*self.quadric.always, *self.quadric.extent]:
            slope = bound.g.at(self.i, self.j)
            if slope < 0:
                margins.append(_ratio(abs(slope), bound.g.spread(self.i, self.j, HALF)))
        return max(margins)


def normal_condition(quadric: ExactQuadric, is_pinhole: bool, form: RayForm, hit: Hit, i: int, j: int) -> float:
    """Error of a unit normal's components per relative error of the spreads; 1 on a cap, inf without a gradient."""
    if hit.kind != SURFACE:
        return 1.0
    with ctx.workprec(BITS):
        ray = _Ray(quadric, is_pinhole, form, i, j)
        t = hit.t.enclosure(BITS)
        depth_change = t * arb(ray.condition(hit.t, ray.root_slope))
        shared = form.c if is_pinhole else form.a
        direct, formed, squares = arb(0), arb(0), arb(0)
        for still, moving in zip(*(affine.rows for affine in quadric.gradient), strict=True):
            value = still.at(i, j) + t * moving.at(i, j)
            squares += value * value
            spread = still.spread(i, j, HALF) + moving.spread(i, j, HALF) * depth_change
            direct = direct.max(spread)
            weight, varying = (still.one, moving) if is_pinhole else (moving.one, still)
            terms = zip(varying, quadric.linear_b, strict=True)
            line = Linear(*(shared * x - weight * b for x, b in terms))
            formed = formed.max(line.spread(i, j, HALF) + abs(weight) * (arb(form.s).sqrt() + ray.root_slope))
        length = squares.sqrt()
        scale = abs(shared / t) if is_pinhole else arb(abs(shared))
        return min(_quotient(direct, length), _quotient(formed, length * scale))


def separation(near: Candidate, far: Candidate) -> float:
    """Relative change of the spreads below which the order of two depths, near.t <= far.t, cannot change.

    In 1/t, where a root at infinity is no further than 0, or in t, whichever tells them apart better.
    """
    with ctx.workprec(BITS):
        t, u = near.hit.t.enclosure(BITS), far.hit.t.enclosure(BITS)
        gap = u - t
        if not gap > 0 or not t > 0:
            return 0.0
        in_depth = gap / (near.condition * t + far.condition * u)
        in_inverse = gap / (near.condition * u + far.condition * t)
        return max(float(in_depth.mid()), float(in_inverse.mid()))


def _ratio(part: fmpz, whole: fmpz) -> float:
    return int(part) / int(whole)


def _quotient(part: arb | fmpz, whole: arb | fmpz) -> float:
    """part/whole as a float; inf where the part is not finite or the whole not clearly positive."""
    if not arb(whole) > 0 or not arb(part).is_finite():
        return math.inf
    return float((arb(part) / whole).mid())
