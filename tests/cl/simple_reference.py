"""The key and the gradient of a simple record at a pixel, to 400 bits, by the formulas of kernels/records.h."""

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, ctx, fmpq

from conicoid.exact import RationalPolynomial

BITS = 400


@dataclass(frozen=True)
class SimpleReference:
    """S and b of the record, exact: polynomials times factors.

    Attributes:
        axes: rows are less the gradients of u, v and depth in target space, as exact numbers (kernels/tile.h).
        principal: of the image, in pixels; None with parallel rays.
    """

    s: RationalPolynomial
    s_factor: fmpq
    b: RationalPolynomial
    b_factor: fmpq
    axes: Sequence[Sequence[fmpq]]
    principal: tuple[fmpq, fmpq] | None

    def at(self, x: int, y: int) -> tuple[arb, list[arb]]:
        """The key, b + sqrt(S), and sum_k axis_k (sqrt(S) b_k + S_k / 2) at the centre of pixel (x, y)."""
        with ctx.workprec(BITS):
            return self._at(fmpq(2 * x + 1, 2), fmpq(2 * y + 1, 2))

    def _at(self, u: fmpq, v: fmpq) -> tuple[arb, list[arb]]:
        uu, uv, vv, along, down, one = (self.s_factor * term / self.s.over for term in self.s.whole)
        s_u, s_v = uu * u + (uv * v + along) / 2, vv * v + (uv * u + down) / 2
        s = s_u * u + s_v * v + (along * u + down * v) / 2 + one
        b_u, b_v, b_one = (self.b_factor * term / self.b.over for term in self.b.whole)
        b = b_u * u + b_v * v + b_one
        root = arb(s).sqrt()
        parts = [arb(s_u) + root * b_u, arb(s_v) + root * b_v]
        if self.principal is None:
            parts.append(root)
        else:
            # Of the polynomials about the principal point: f = (u - cx) f_u + (v - cy) f_v + f_depth.
            right, below = u - self.principal[0], v - self.principal[1]
            deeper = arb(s - right * s_u - below * s_v) + root * (b - right * b_u - below * b_v)
            parts.append(deeper)
        gradient = [
            sum((part * axis[j] for part, axis in zip(parts, self.axes, strict=True)), arb(0)) for j in range(3)
        ]
        return arb(b) + root, gradient
