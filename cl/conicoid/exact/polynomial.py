"""Polynomials in pixel coordinates (u, v) with integer coefficients."""

from typing import NamedTuple

from flint import fmpz


class Linear(NamedTuple):
    """u, v and constant coefficients."""

    u: fmpz
    v: fmpz
    one: fmpz

    def at(self, u: fmpz, v: fmpz) -> fmpz:
        """The value at one place."""
        return self.u * u + self.v * v + self.one

    def about(self, u0: int, v0: int) -> "Linear":
        """The same function of (u - u0, v - v0)."""
        return Linear(self.u, self.v, self.u * u0 + self.v * v0 + self.one)

    def times(self, other: "Linear") -> "Quadratic":
        """The product of two functions."""
        return Quadratic(
            self.u * other.u,
            self.u * other.v + self.v * other.u,
            self.v * other.v,
            self.u * other.one + self.one * other.u,
            self.v * other.one + self.one * other.v,
            self.one * other.one,
        )

    def doubled(self) -> "Linear":
        """Four times the function, of (2u, 2v), which are integers at the centres of pixels."""
        return Linear(2 * self.u, 2 * self.v, 4 * self.one)


class Quadratic(NamedTuple):
    """uu, uv, vv, u, v and constant coefficients."""

    uu: fmpz
    uv: fmpz
    vv: fmpz
    u: fmpz
    v: fmpz
    one: fmpz

    def at(self, u: fmpz, v: fmpz) -> fmpz:
        """The value at one place."""
        return (self.uu * u + self.uv * v + self.u) * u + (self.vv * v + self.v) * v + self.one

    def about(self, u0: int, v0: int) -> "Quadratic":
        """The same function of (u - u0, v - v0)."""
        return Quadratic(
            self.uu,
            self.uv,
            self.vv,
            2 * self.uu * u0 + self.uv * v0 + self.u,
            self.uv * u0 + 2 * self.vv * v0 + self.v,
            (self.uu * u0 + self.uv * v0 + self.u) * u0 + (self.vv * v0 + self.v) * v0 + self.one,
        )

    def times(self, factor: fmpz) -> "Quadratic":
        """The function times a number."""
        return Quadratic(*[factor * value for value in self])

    def plus(self, other: "Quadratic") -> "Quadratic":
        """The sum of two functions."""
        return Quadratic(*[x + y for x, y in zip(self, other, strict=True)])

    def doubled(self) -> "Quadratic":
        """Four times the function, of (2u, 2v), which are integers at the centres of pixels."""
        return Quadratic(self.uu, self.uv, self.vv, 2 * self.u, 2 * self.v, 4 * self.one)
