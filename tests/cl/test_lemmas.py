"""What the bounds use of geometry and algebra, in exact numbers."""

from itertools import combinations, product

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
