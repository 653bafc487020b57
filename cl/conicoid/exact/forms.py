"""One quadric along the rays of a camera: the polynomials in the pixel that decide it, as exact rationals."""

from dataclasses import dataclass, replace

from flint import fmpq

from conicoid.exact.polynomial import Linear, Quadratic


@dataclass(frozen=True)
class ExactForms:
    """Polynomials in pixel coordinates (u, v); pixel (i, j) is sampled at (i + 1/2, j + 1/2).

    With f as in the scene document, unscaled, and X + tY the ray in parameter space (object space over the radii):

    Attributes:
        a, b, c: f = a t^2 + 2b t + c on the ray: Y'DY, X'DY, X'DX.
        s: b^2 - ac.
        range: X3 - z0/c and X3 - z1/c, c the third radius; empty without a z_range.
        height: Y3.
        cap: f where the ray meets z0 and z1, times Y3^2; empty without a z_range.
    """

    a: Quadratic
    b: Linear
    c: Quadratic
    s: Quadratic
    range: tuple[Linear, ...]
    height: Linear
    cap: tuple[Quadratic, ...]

    def about(self, u0: int, v0: int) -> "ExactForms":
        """The same polynomials of (u - u0, v - v0)."""
        return replace(
            self,
            a=self.a.about(u0, v0),
            b=self.b.about(u0, v0),
            c=self.c.about(u0, v0),
            s=self.s.about(u0, v0),
            range=tuple(plane.about(u0, v0) for plane in self.range),
            height=self.height.about(u0, v0),
            cap=tuple(conic.about(u0, v0) for conic in self.cap),
        )


def discriminant(a: Quadratic, b: Linear, c: Quadratic, *, orthographic: bool) -> Quadratic:
    """b^2 - ac, of which a (orthographic) or c (pinhole) is constant."""
    product = c.times(a.one) if orthographic else a.times(c.one)
    return b.times(b).plus(product.times(fmpq(-1)))


def cap_conic(a: Quadratic, b: Linear, c: Quadratic, offset: Linear, slope: Linear, *, orthographic: bool) -> Quadratic:
    """The conic a e^2 - 2b e g + c g^2 of the plane e + g t = 0; e (pinhole) or g (orthographic) is constant."""
    fixed, moving = (slope.one, offset) if orthographic else (offset.one, slope)
    outer, inner = (c, a.one) if orthographic else (a, c.one)
    squares = outer.times(fixed * fixed).plus(moving.times(moving).times(inner))
    return squares.plus(b.times(moving).times(-2 * fixed))


def double_double(value: fmpq) -> tuple[float, float]:
    """The nearest binary64 and the nearest binary64 to what it leaves; gradual underflow.

    Raises:
        OverflowError: the value is beyond binary64.
    """
    high = int(value.p) / int(value.q)
    rest = value - fmpq(*high.as_integer_ratio())
    return high, int(rest.p) / int(rest.q)
