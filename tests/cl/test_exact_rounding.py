"""Rounding of exact numbers to binary32: midpoints, zeros, and both ends of the range."""

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq, fmpz
from hypothesis import given
from hypothesis import strategies as st

from conicoid.exact.rounding import nearest_float32
from conicoid.exact.surd import Surd, SurdOverRoot, compare, sign_of_sum
from tests.cl.exact_pixels import ORTHOGRAPHIC, PINHOLE, hit

small = st.integers(-40, 40)
whole = st.integers(-(2**80), 2**80)
floats32 = st.floats(width=32, allow_nan=False, allow_infinity=False)


def rational(value: Fraction) -> Surd:
    return Surd(fmpz(value.numerator), fmpz(0), fmpz(0), fmpz(value.denominator))


# Odd and longer than the first precision: its multiples, as roots of their squares, are not enclosed exactly.
LONG = fmpz(3) ** 100


def root(value: Fraction) -> Surd:
    """The same number as a square root that happens to be rational."""
    side = 1 if value > 0 else -1
    return Surd(fmpz(0), fmpz(side), (value.numerator * LONG) ** 2, value.denominator * LONG)


def quotient(value: Fraction) -> SurdOverRoot:
    """The same number as (p + 5 sqrt(s)) / sqrt(m + 2 sqrt(s)) with sqrt(s) = 3^100."""
    under = (value.denominator * LONG) ** 2
    return SurdOverRoot((value.numerator - 5) * LONG, fmpz(5), under - 2 * LONG, fmpz(2), LONG * LONG)


@given(floats32)
def test_binary32_values_stay_what_they_are(value: float) -> None:
    for number in (rational, root, quotient):
        rounded = nearest_float32(number(Fraction(value)))
        assert rounded == value
        assert math.copysign(1, rounded) == 1 or value < 0


@given(floats32)
def test_midpoints_go_to_even_and_their_neighbours_to_their_side(value: float) -> None:
    low = np.float32(abs(value))
    with np.errstate(over="ignore"):
        high = np.nextafter(low, np.float32(np.inf))
    top = Fraction(2) ** 128 if np.isinf(high) else Fraction(float(high))
    middle = (Fraction(float(low)) + top) / 2
    even = low if low.view(np.uint32) % 2 == 0 else high
    little = Fraction(1, 10**400)
    for number in (rational, root, quotient):
        assert nearest_float32(number(middle)) == even
        assert nearest_float32(number(-middle)) == -even
        assert nearest_float32(number(middle - little)) == low
        assert nearest_float32(number(middle + little)) == high
        assert nearest_float32(number(-middle + little)) == -low
        assert nearest_float32(number(-middle - little)) == -high


@given(st.fractions(), st.integers(-200, 200))
def test_fractions_round_as_numpy_rounds_what_binary64_holds(value: Fraction, exponent: int) -> None:
    held = Fraction(float(value) * 2.0**exponent)
    with np.errstate(over="ignore", under="ignore"):
        expected = np.float32(float(held))
    assert nearest_float32(rational(held)) == expected


@given(small, small, st.integers(0, 40), small, small, st.integers(0, 40))
def test_order_of_surds_is_that_of_close_approximations(p: int, k: int, s: int, q: int, m: int, t: int) -> None:
    first, second = Surd(*map(fmpz, (p, k, s, 7))), Surd(*map(fmpz, (q, m, t, 5)))
    difference = p / 7 - q / 5 + k * math.sqrt(s) / 7 - m * math.sqrt(t) / 5
    # The product of the four conjugates of 35 times the difference is an integer, and each is below 4000: so unless
    # the difference is 0 it is above 4e-13. Binary64 errs by less than 1e-13 here.
    expected = 0 if abs(difference) < 1e-13 else int(math.copysign(1, difference))
    assert compare(first, second) == expected == -compare(second, first)


@given(whole, whole, st.integers(0, 2**80))
def test_sign_of_a_surd_times_its_conjugate_is_that_of_the_norm(p: int, k: int, s: int) -> None:
    signs = [sign_of_sum(fmpz(p), fmpz(k * side), fmpz(s)) for side in (1, -1)]
    norm = p * p - k * k * s
    assert signs[0] * signs[1] == (norm > 0) - (norm < 0)
    assert compare(Surd(*map(fmpz, (p, k, s, 1))), Surd(*map(fmpz, (p, k, s, 1)))) == 0


def test_a_surd_one_part_in_1e60_off_a_midpoint_is_told_from_it() -> None:
    """sqrt(n^2 ± 1)/n for n = 10^30 times the midpoint of 1 and its successor."""
    n, middle = fmpz(10) ** 30, fmpq(2**24 + 1, 2**24)
    above, below = (Surd(fmpz(0), middle.p, n * n + side, middle.q * n) for side in (1, -1))
    assert nearest_float32(above) == float(np.float32(1 + 2.0**-23))
    assert nearest_float32(below) == 1


@pytest.mark.parametrize(("odd", "expected"), [(1, 1.0), (3, 1 + 2.0**-22), (5, 1 + 2.0**-22)])
def test_depth_halfway_between_two_floats_goes_to_even(odd: int, expected: float) -> None:
    depth = 1 + odd * 2.0**-24
    assert hit([{"shape": "plane", "center": [0, 0, -depth]}], ORTHOGRAPHIC).z == expected


@pytest.mark.parametrize(("nudge", "expected"), [(0, 1.25), (-(2.0**-52), 1.25), (2.0**-52, 1.25 + 2.0**-23)])
def test_distance_halfway_between_two_floats_goes_to_even(nudge: float, expected: float) -> None:
    """The plane z = -4m/5 meets a ray 5/4 long at a distance of m."""
    distance = 1.25 + 2.0**-24 + nudge
    plane = {"shape": "quadric", "coefficients": [0, 0, 0, 0, 0, 0, 0, 0, 2.5, 4 * distance]}
    assert hit([plane], {**PINHOLE, "fx": 4}, i=3).t == expected


@pytest.mark.parametrize(("nudge", "steps"), [(0, 0), (-(2.0**-52), 0), (2.0**-52, 1)])
@pytest.mark.parametrize(("vector", "step"), [("normal", 2.0**-23), ("position", 2.0**-22)])
def test_components_halfway_between_two_steps_go_to_even(vector: str, step: float, nudge: float, steps: int) -> None:
    """A unit ball's normal is its position but for its middle; x is rational, and z, near -3.1, sets the step."""
    camera = {**ORTHOGRAPHIC, "fx": 2, "cx": -step - 2 * nudge - 0.5}
    pixel = hit([{"shape": "sphere", "center": [0, 0, -4]}], camera)
    assert getattr(pixel, vector)[0] == 0.5 + steps * step


def test_small_components_are_as_coarse_as_large_ones() -> None:
    camera = {**ORTHOGRAPHIC, "cx": 0.5 - 2.0**-30}
    pixel = hit([{"shape": "sphere", "center": [0, 0, -4]}], camera)
    assert pixel.normal == (0.0, 0.0, 1.0)
    assert pixel.position == (0.0, 0.0, -3.0)


def test_depths_beyond_binary32_are_hits_all_the_same() -> None:
    far = hit([{"shape": "plane", "center": [0, 0, -1e39]}], PINHOLE, i=3)
    assert (far.z, far.t, far.position) == (math.inf, math.inf, (math.inf, 0, -math.inf))
    close = hit([{"shape": "plane", "center": [0, 0, -1e-46]}], PINHOLE, i=3)
    assert (close.z, close.t, close.position) == (0, 0, (0, 0, 0))
    assert math.copysign(1, close.position[2]) == 1
    last = hit([{"shape": "plane", "center": [0, 0, -(2.0**-149) * 0.75]}], PINHOLE)
    assert last.z == 2.0**-149
