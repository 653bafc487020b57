"""Rational polynomials in pixel coordinates (u, v), and their integer values at pixel centres."""

from typing import NamedTuple

from flint import fmpq, fmpz

Integers = tuple[fmpz, ...]


class Linear(NamedTuple):
    """u, v and constant coefficients."""

    u: fmpq
    v: fmpq
    one: fmpq

    def about(self, u0: int, v0: int) -> "Linear":
        """The same function of (u - u0, v - v0)."""
        return Linear(self.u, self.v, self.u * u0 + self.v * v0 + self.one)

    def over(self, divisor: fmpq) -> "Linear":
        """The function divided by a number."""
        return Linear(self.u / divisor, self.v / divisor, self.one / divisor)

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

    def doubled(self) -> list[fmpq]:
        """Coefficients of four times the value in the integers (2u, 2v)."""
        return [2 * self.u, 2 * self.v, 4 * self.one]


class Quadratic(NamedTuple):
    """uu, uv, vv, u, v and constant coefficients."""

    uu: fmpq
    uv: fmpq
    vv: fmpq
    u: fmpq
    v: fmpq
    one: fmpq

    def about(self, u0: int, v0: int) -> "Quadratic":
        """The same function of (u - u0, v - v0)."""
        return self._replace(
            u=2 * self.uu * u0 + self.uv * v0 + self.u,
            v=self.uv * u0 + 2 * self.vv * v0 + self.v,
            one=(self.uu * u0 + self.uv * v0 + self.u) * u0 + (self.vv * v0 + self.v) * v0 + self.one,
        )

    def times(self, factor: fmpq) -> "Quadratic":
        """The function times a number."""
        return Quadratic(*(factor * value for value in self))

    def plus(self, other: "Quadratic") -> "Quadratic":
        """The sum of two functions."""
        return Quadratic(*(x + y for x, y in zip(self, other, strict=True)))

    def doubled(self) -> list[fmpq]:
        """Coefficients of four times the value in the integers (2u, 2v)."""
        return [self.uu, self.uv, self.vv, 2 * self.u, 2 * self.v, 4 * self.one]


def linear_at(c: Integers, u: fmpz, v: fmpz) -> fmpz:
    """Value of the coefficients u, v, 1."""
    return c[0] * u + c[1] * v + c[2]


def quadratic_at(c: Integers, u: fmpz, v: fmpz) -> fmpz:
    """Value of the coefficients uu, uv, vv, u, v, 1."""
    return (c[0] * u + c[1] * v + c[3]) * u + (c[2] * v + c[4]) * v + c[5]
