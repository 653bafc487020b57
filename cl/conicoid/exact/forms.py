"""One quadric along the rays of a camera: the polynomials in the pixel that decide it, as exact rationals."""

from dataclasses import dataclass

import numpy as np
from flint import fmpz

from conicoid.exact.polynomial import Linear, Quadratic
from conicoid.scene import Floats


@dataclass(frozen=True)
class RationalPolynomial:
    """The polynomial `whole` / `over` of pixel coordinates; `over` is positive."""

    whole: Linear | Quadratic
    over: fmpz

    def about(self, u0: int, v0: int) -> "RationalPolynomial":
        """The same function of (u - u0, v - v0)."""
        return RationalPolynomial(self.whole.about(u0, v0), self.over)

    def vanishes(self) -> bool:
        """Whether it is 0 at every pixel."""
        return not any(self.whole)

    def rounded(self, exponent: int = 0) -> Floats:
        """(k,) float64, the coefficients times 2^exponent, each rounded once.

        Raises:
            OverflowError: a coefficient is beyond binary64.
        """
        up, down = max(exponent, 0), max(-exponent, 0)
        return np.array([(int(value) << up) / (int(self.over) << down) for value in self.whole])


@dataclass(frozen=True)
class ExactForms:
    """Polynomials in pixel coordinates (u, v); pixel (i, j) is sampled at (i + 1/2, j + 1/2).

    Coefficients are in the order of `kernels/records.h`: uu, uv, vv, u, v, 1, or u, v, 1. With f as in the scene
    document, unscaled, and X + tY the ray in parameter space (object space over the radii):

    Attributes:
        a, b, c: f = a t^2 + 2b t + c on the ray: Y'DY, X'DY, X'DX.
        s: b^2 - ac.
        range: X3 - z0/c and X3 - z1/c, c the third radius; empty without a z_range.
        height: Y3.
        cap: f where the ray meets z0 and z1, times Y3^2; empty without a z_range.
    """

    a: RationalPolynomial
    b: RationalPolynomial
    c: RationalPolynomial
    s: RationalPolynomial
    range: tuple[RationalPolynomial, ...]
    height: RationalPolynomial
    cap: tuple[RationalPolynomial, ...]

    def about(self, u0: int, v0: int) -> "ExactForms":
        """The same polynomials of (u - u0, v - v0)."""
        return ExactForms(
            a=self.a.about(u0, v0),
            b=self.b.about(u0, v0),
            c=self.c.about(u0, v0),
            s=self.s.about(u0, v0),
            range=tuple(plane.about(u0, v0) for plane in self.range),
            height=self.height.about(u0, v0),
            cap=tuple(conic.about(u0, v0) for conic in self.cap),
        )


def discriminant(a: Quadratic, b: Linear, c: Quadratic, *, orthographic: bool) -> Quadratic:
    """The conic b^2 - ac; a (orthographic) or c (pinhole) is constant."""
    product = c.times(a.one) if orthographic else a.times(c.one)
    return b.times(b).plus(product.times(fmpz(-1)))


def cap_conic(a: Quadratic, b: Linear, c: Quadratic, plane: tuple[Linear, Linear], *, orthographic: bool) -> Quadratic:
    """The conic a e^2 - 2b e g + c g^2 of the plane e + g t = 0; e (pinhole) or g (orthographic) is constant."""
    offset, slope = plane
    fixed, moving = (slope.one, offset) if orthographic else (offset.one, slope)
    outer, inner = (c, a.one) if orthographic else (a, c.one)
    squares = outer.times(fixed * fixed).plus(moving.times(moving).times(inner))
    return squares.plus(b.times(moving).times(-2 * fixed))
