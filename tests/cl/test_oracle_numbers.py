"""The oracle's arithmetic: signs and orders of surds, and correct rounding."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq, fmpz
from hypothesis import example, given
from hypothesis import strategies as st

from tests.oracle.rounding import closest_float, exact, nearest_float32
from tests.oracle.shading import planar_depth
from tests.oracle.surd import Surd, compare, sign_of_linear, sign_of_sum

small = st.integers(-30, 30)
radicand = st.integers(0, 40)
DIGITS = 10**60


def approximate(r: int, k: int, s: int, m: int) -> Fraction:
    """(r + k√s)/m to 60 digits: the numbers drawn here differ by more than 1e-12 or not at all."""
    return (r + Fraction(k * math.isqrt(s * DIGITS * DIGITS), DIGITS)) / m


def as_sign(value: Fraction) -> int:
    return 0 if abs(value) < Fraction(1, 10**40) else int(math.copysign(1, value))


def surd(r: int, k: int, s: int, m: int) -> Surd:
    return Surd(fmpz(r), fmpz(k), fmpz(s), fmpz(m))


@given(small, small, radicand)
@example(-3, 1, 9)
def test_sign_of_a_sum_with_a_root(a: int, b: int, s: int) -> None:
    assert sign_of_sum(fmpz(a), fmpz(b), fmpz(s)) == as_sign(approximate(a, b, s, 1))


@given(st.tuples(small, small, radicand, st.integers(1, 9)), st.tuples(small, small, radicand, st.integers(1, 9)))
@example((0, 2, 3, 1), (0, 1, 12, 1))
@example((1, 1, 2, 1), (1, 1, 2, 1))
@example((-6, 2, 9, 5), (0, 7, 0, 3))
def test_order_of_two_surds(x: tuple[int, int, int, int], y: tuple[int, int, int, int]) -> None:
    assert compare(surd(*x), surd(*y)) == as_sign(approximate(*x) - approximate(*y))


def test_order_beyond_any_filter() -> None:
    # sqrt(2) against its convergents p/q, with p^2 - 2 q^2 = ±1 and q of 400 bits: they differ by about 2^-800.
    p, q = 1, 1
    while q.bit_length() < 400:
        p, q = p + 2 * q, p + q
    sign = compare(surd(0, 1, 2, 1), surd(p, 0, 0, q))
    assert sign == (1 if p * p < 2 * q * q else -1)
    assert compare(surd(p, 0, 0, q), surd(0, 1, 2, 1)) == -sign
    # p/q·√3 against √6: the same question between two different roots.
    assert compare(surd(0, p, 3, q), surd(0, 1, 6, 1)) == -sign
    assert compare(surd(0, -p, 3, q), surd(0, -1, 6, 1)) == sign


@given(small, small, st.tuples(small, small, radicand, st.integers(1, 9)))
def test_sign_of_a_linear_function_of_a_surd(e: int, g: int, x: tuple[int, int, int, int]) -> None:
    assert sign_of_linear(fmpz(e), fmpz(g), surd(*x)) == as_sign(e + g * approximate(*x))


@given(st.floats(allow_nan=False, allow_infinity=False))
@example(2.0**128 - 2.0**103)  # the tie between the largest float32 and 2^128 goes to inf
@example(math.nextafter(2.0**128 - 2.0**103, 0))
@example(2.0**-150)  # half of the smallest subnormal: a tie that goes to 0
@example(3 * 2.0**-150)
@example(2.0**-127 + 1.3 * 2.0**-149)  # a subnormal: rounded to 24 bits first, it would go up
@example(1 + 2.0**-24)
@example(1 + 3 * 2.0**-24)
@example(2.0**-126 - 2.0**-151)
def test_nearest_float32_is_what_ieee_hardware_rounds_to(value: float) -> None:
    with np.errstate(over="ignore", under="ignore"):
        expected = np.float32(np.float64(value))
    got = nearest_float32(exact(value))
    assert got == expected
    assert np.abs(got).dtype == np.float32


@given(st.integers(1, 2**70), st.integers(1, 2**70))
def test_nearest_float32_of_a_rational_is_no_further_than_its_neighbours(p: int, q: int) -> None:
    value = Fraction(p, q)
    got = nearest_float32(fmpq(p, q))
    for other in (np.nextafter(got, np.float32(0)), np.nextafter(got, np.float32(np.inf))):
        assert abs(Fraction(float(got)) - value) <= abs(Fraction(float(other)) - value)


@pytest.mark.parametrize("bits", [24, 25, 100, 1000])
def test_a_root_just_beside_a_midpoint_rounds_to_its_own_side(bits: int) -> None:
    midpoint = fmpq(2**24 + 1, 2**24)
    for side in (-1, 1):
        square = midpoint**2 + side * fmpq(1, 2**bits)
        number = Surd(fmpz(0), fmpz(1), square.p * square.q, square.q)
        got = planar_depth(number)
        assert got == np.float32(1 if side < 0 else 1 + 2.0**-23)


def test_a_root_that_is_a_midpoint_goes_to_the_even_neighbour() -> None:
    # sqrt((2^24 + 1)^2)/2^24: the enclosure never says that it is rational, the tie is found by its exact sign.
    number = Surd(fmpz(0), fmpz(1), fmpz((2**24 + 1) ** 2), fmpz(2**24))
    odd = Surd(fmpz(0), fmpz(1), fmpz((2**24 + 3) ** 2), fmpz(2**24))
    for x, expected in ((number, 1.0), (odd, 1 + 2.0**-22)):
        got = planar_depth(x)
        assert got == np.float32(expected)


def test_cancellation_costs_precision_bits_not_accuracy() -> None:
    # 10^100 - sqrt(10^200 - 1), about 5e-101.
    number = Surd(fmpz(10) ** 100, fmpz(-1), fmpz(10) ** 200 - 1, fmpz(1))
    assert closest_float(number.enclosure) == pytest.approx(5e-101, rel=2.0**-50)


def test_enclosures_enclose() -> None:
    number = surd(-7, 5, 2, 3)
    with ctx.workprec(300):
        fine = (-7 + 5 * arb(2).sqrt()) / 3
    assert number.enclosure(40).contains(fine)
