"""The error statistics, on pictures made by hand."""

from itertools import count

import numpy as np
import pytest

from conicoid_bench.measure import Errors, angles, compare, float32_steps, timed
from conicoid_bench.picture import Job, Picture


def picture(depths: list[float], ids: list[int], normals: list[list[float]] | None = None) -> Picture:
    normal = np.array(normals or [[0, 0, 1]] * len(ids), dtype=np.float32)
    return Picture(np.array([depths], np.float32), np.array([ids], np.uint32), normal[None])


def test_a_picture_is_not_wrong_about_itself() -> None:
    exact = picture([1, 2, np.inf], [1, 2, 0])
    assert compare(exact, exact) == Errors(0, 0, 0, 0, 0)


def test_hits_and_ids_are_counted_apart_and_only_common_pixels_compared() -> None:
    exact = picture([1, 2, 3, 4, np.inf, np.inf], [1, 1, 2, 2, 0, 0])
    got = picture([1, np.inf, 9, 4, 7, np.inf], [1, 0, 1, 2, 5, 0])
    assert compare(got, exact) == Errors(wrong_hits=2, wrong_ids=1, worst_ulp=0, median_ulp=0, worst_degrees=0)


def test_depths_are_compared_in_float32_numbers() -> None:
    exact = picture([1, 1, 1], [1, 1, 1])
    got = picture([1 + 2.0**-23, 1 - 2.0**-24, 1 + 5 * 2.0**-23], [1, 1, 1])
    assert compare(got, exact) == Errors(0, 0, worst_ulp=5, median_ulp=1, worst_degrees=0)


def test_without_a_common_pixel_there_is_no_error_to_tell() -> None:
    assert compare(picture([1], [1]), picture([np.inf], [0])) == Errors(1, 0, None, None, None)
    assert compare(picture([1], [1]), picture([1], [2])) == Errors(0, 1, None, None, None)


@pytest.mark.parametrize(
    ("got", "exact", "steps"),
    [(0.0, -0.0, 0), (2.0**-149, -(2.0**-149), 2), (np.inf, np.finfo(np.float32).max, 1), (np.nan, 1.0, 1 << 32)],
)
def test_steps_count_every_number_between(got: float, exact: float, steps: int) -> None:
    assert float32_steps(np.array([got], np.float32), np.array([exact], np.float32)).tolist() == [steps]


def test_angles_small_and_large_are_told() -> None:
    # tan of the angle is given; 1e-6 rad is below what acos of a float64 dot product can tell to 1 %.
    got = np.array([[0, 1e-6, 1], [0, 2, 2], [0, 0, -1], [0, 0, 0], [np.nan, 0, 1]], dtype=np.float32)
    exact = np.tile(np.array([0, 0, 1], dtype=np.float32), (5, 1))
    # binary32 rounds 1e-6 to within 6e-8 of it.
    assert angles(got, exact) == pytest.approx([np.degrees(1e-6), 45, 0, 90, 90], rel=1e-7)


def test_the_first_run_only_warms_and_at_least_three_are_timed() -> None:
    calls = count(1)
    result, times = timed(Job(lambda: next(calls), lambda _: picture([1], [1])))
    assert result == len(times) + 1 >= 4
