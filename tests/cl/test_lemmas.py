"""What the bounds use of geometry and algebra, in exact numbers."""

from fractions import Fraction
from itertools import combinations, product

import pytest
from flint import fmpq, fmpq_poly

from tests.cl.roundings import UNIT_ROUNDOFF, constant, gamma


def beyond_the_rim(summit: int) -> list[fmpq_poly]:
    """S as computed and raised, at most, at 1 + 10^-6 + x times the way from an ellipse's middle to its rim.

    In units of its error in the box, which magnitudes of functions linear in the pixel let grow by (2 rho - 1)^2. Two
    polynomials in x, of which the second counts y times, where S is summit + y in the middle.
    """
    rho = fmpq_poly([1 + fmpq(1, 10**6), 1])
    falls = 1 - rho**2
    grows = (2 * rho - 1) ** 2
    return [summit * falls + grows + 1, falls]


def is_negative(bound: list[fmpq_poly]) -> bool:
    """For all x, y >= 0, as no coefficient is positive, and the constant one negative."""
    return bound[0][0] < 0 and all(coefficient <= 0 for part in bound for coefficient in part.coeffs())


def test_no_pixel_beyond_a_sharp_ellipse_is_hit() -> None:
    needed = constant("simple_forms.h", r"alone = .* \(summit > 0x1p(\d+) \* s_error\)")
    # The middle's own S is computed too.
    assert is_negative(beyond_the_rim(2 ** int(needed) - 1))
    assert not is_negative(beyond_the_rim(2**19))
    assert constant("bounds.cl", r"\(1\.0 \+ 1e-(\d+)\)") == constant("bounds.cl", r"slack = 1e-(\d+)") == 6


def test_a_cross_product_is_within_3u_of_its_factors() -> None:
    """sum (p_i q_j + p_j q_i)^2 = 2 |p|^2 |q|^2 - sum (p_i q_j - p_j q_i)^2 - 2 sum (p_i q_i)^2."""
    pairs = list(combinations(range(3), 2))
    # Both sides have degree 2 in each of the six: what holds on three values of each holds everywhere.
    for numbers in product(range(3), repeat=6):
        p, q = numbers[:3], numbers[3:]
        magnitudes = sum((p[i] * q[j] + p[j] * q[i]) ** 2 for i, j in pairs)
        twice = 2 * sum(x * x for x in p) * sum(x * x for x in q)
        squares = sum((p[i] * q[j] - p[j] * q[i]) ** 2 for i, j in pairs) + 2 * sum(
            (x * y) ** 2 for x, y in zip(p, q, strict=True)
        )
        assert magnitudes == twice - squares
    # A product and a difference.
    assert 2 * gamma(2) ** 2 <= (3 * UNIT_ROUNDOFF) ** 2


@pytest.mark.parametrize("orthographic", [False, True])
def test_the_exact_depth_is_between_the_two_that_are_rounded(*, orthographic: bool) -> None:
    """Of a key that is off by k times itself, u <= k <= 2^-10; above, binary32 tells the two apart.

    Both are affine in k and in the relative error of each operation, so that corners are enough: 1 / (1 + k) >= 1 - k
    and 1 / (1 - k) <= 1 + 1.001 k. The unit is a power of two; with parallel rays t is the key, but for its sign.
    """
    grows = Fraction(1) if orthographic else constant("channels.h", r"\(real\)\(([\d.]+) / f->unit\)")
    rounding = constant("channels.h", r"per_unit\) \+ (\d+) \* UNIT_ROUNDOFF")
    u = UNIT_ROUNDOFF / (1 + UNIT_ROUNDOFF)
    farther, nearer = (1, 1) if orthographic else (Fraction(1001, 1000), 1)
    for k in (UNIT_ROUNDOFF, Fraction(1, 2**10)):
        for quotient, in_error, first, second, third, added, along, last in product((-u, u), repeat=8):
            depth = 1 + (0 if orthographic else quotient)
            scaled = k * grows * (1 + in_error) * (1 + first) * (1 if orthographic else (1 + second) * (1 + third))
            error = (scaled + rounding * UNIT_ROUNDOFF) * (1 + added) * (1 + along)
            assert depth * (1 - error) * (1 + last) <= 1 - nearer * k
            assert depth * (1 + error) * (1 + last) >= 1 + farther * k
