"""Cameras: focal lengths, poses and windows, derived by the documented steps to the last bit."""

import json
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import assume, example, given
from hypothesis import strategies as st

from conicoid.document import parse
from conicoid.document.tangent import tan_half
from conicoid.errors import SceneError
from conicoid.scene import Camera
from tests.cl.rounded import add, divide, multiply, root, scaled, subtract

IDENTITY = np.eye(4).tolist()


def camera(**keys: Any) -> Camera:
    whole = {"conicoid": 1, "quadrics": [], "camera": {"width": 640, "height": 480} | keys}
    return parse(json.dumps(whole).encode()).resolve().camera


def test_a_pinhole_has_defaults() -> None:
    plain = camera(fov_y=90)
    assert (plain.projection, plain.fx, plain.fy, plain.cx, plain.cy) == ("pinhole", 240, 240, 320, 240)
    assert plain.world_from_camera.tolist() == IDENTITY
    assert (plain.near, plain.far, plain.crop) == (0, math.inf, (0, 0, 640, 480))


def test_pixels_are_square_under_one_angle() -> None:
    assert camera(fov_x=90).fx == camera(fov_x=90).fy == 320
    assert camera(fx=7, fy=5).fx == 7
    assert camera(fx=7, fy=5).fy == 5


def test_an_orthographic_view_is_as_high_as_its_view_height() -> None:
    view = camera(projection="orthographic", view_height=3)
    assert (view.projection, view.fx, view.fy, view.cx, view.cy) == ("orthographic", 160, 160, 320, 240)
    assert camera(projection="orthographic", fx=2, fy=3).fy == 3


def test_odd_sizes_put_the_principal_point_on_a_half() -> None:
    odd = camera(width=5, height=7, fov_y=50)
    assert (odd.cx, odd.cy) == (2.5, 3.5)
    assert (camera(fov_y=50, cx=0).cx, camera(fov_y=50, cy=-1.25).cy) == (0, -1.25)


angles = st.floats(0, 180, exclude_min=True, exclude_max=True)


def is_nearest_tangent(degrees: float, tangent: float) -> bool:
    """Whether the tangent of half the angle lies strictly between the midpoints to a number's two neighbours."""
    low = (Fraction(tangent) + Fraction(math.nextafter(tangent, -1))) / 2
    high = (Fraction(tangent) + Fraction(math.nextafter(tangent, math.inf))) / 2
    with ctx.workprec(2400):
        exact = (arb.pi() * arb(degrees) / 360).tan()
        return bool(_arb(low) < exact) and bool(exact < _arb(high))


def _arb(exact: Fraction) -> arb:
    return arb(exact.numerator) / exact.denominator


@given(angles)
@example(5e-324)
@example(1e-310)
@example(2.2250738585072014e-308)
@example(120.0)
@example(math.nextafter(90.0, 0))
@example(math.nextafter(90.0, 180))
@example(math.nextafter(180.0, 0))
def test_the_tangent_is_correctly_rounded(degrees: float) -> None:
    assert is_nearest_tangent(degrees, tan_half(degrees))


def test_the_tangent_of_45_degrees_is_1() -> None:
    assert tan_half(90.0) == 1


def test_the_working_precision_of_flint_is_left_alone() -> None:
    before = ctx.prec
    tan_half(77.0)
    assert ctx.prec == before


@given(angles, st.integers(1, 65536))
def test_a_focal_length_follows_the_documented_steps(degrees: float, height: int) -> None:
    tangent = tan_half(degrees)
    assume(tangent > 1e-300)
    focal = divide(height, multiply(2, tangent))
    view = camera(fov_y=degrees, height=height)
    assert view.fx == view.fy == focal


def test_opencv_axes_are_opengl_axes_with_y_and_z_turned_round() -> None:
    pose = [[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7], [0, 0, 0, 1]]
    assert camera(fov_y=40, world_from_camera=pose).world_from_camera.tolist() == pose
    turned = camera(fov_y=40, world_from_camera=pose, convention="opencv").world_from_camera
    assert turned.tolist() == [[0, 0, -1, 5], [1, 0, 0, 6], [0, -1, 0, 7], [0, 0, 0, 1]]
    assert not np.signbit(turned[turned == 0]).any()
    assert camera(fov_y=40, convention="opencv").world_from_camera.tolist() == np.diag([1, -1, -1, 1]).tolist()


def test_look_at_views_the_target_under_either_convention() -> None:
    for convention in ("opengl", "opencv"):
        view = camera(fov_y=40, convention=convention, look_at={"eye": [1, 2, 8], "target": [1, 2, 3], "up": [0, 9, 4]})
        assert view.world_from_camera.tolist() == [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 8], [0, 0, 0, 1]]


def normalised(vector: list[float]) -> list[float]:
    x, y, z = scaled(vector)
    length = root(add(add(multiply(x, x), multiply(y, y)), multiply(z, z)))
    return [divide(part, length) for part in (x, y, z)]


def cross(p: list[float], q: list[float]) -> list[float]:
    (a, b, c), (d, e, f) = p, q
    pairs = ((b, f, c, e), (c, d, a, f), (a, e, b, d))
    return [subtract(multiply(k, m), multiply(n, o)) for k, m, n, o in pairs]


components = st.floats(-1e6, 1e6) | st.sampled_from([0.0, 1e-320, 1e300, -1e308, 1.7976931348623157e308])
points = st.lists(components, min_size=3, max_size=3)


@given(points, points, points)
@example([1e308, 0, 0], [-1e308, 1e308, 0], [0, 0, 1e-320])
def test_look_at_follows_the_documented_steps_to_the_last_bit(
    eye: list[float], target: list[float], up: list[float]
) -> None:
    try:
        pose = camera(fov_y=40, look_at={"eye": eye, "target": target, "up": up}).world_from_camera
    except SceneError:
        assume(False)
    try:
        z = normalised([subtract(a, b) for a, b in zip(eye, target, strict=True)])
    except OverflowError:
        z = normalised([subtract(multiply(0.25, a), multiply(0.25, b)) for a, b in zip(eye, target, strict=True)])
    x = normalised(cross(normalised(up), z))
    y = normalised(cross(z, x))
    columns = [[*axis, 0] for axis in (x, y, z)] + [[*eye, 1]]
    assert pose.T.tolist() == columns


@given(points, points, points)
def test_look_at_gives_a_pose_that_is_taken_as_one(eye: list[float], target: list[float], up: list[float]) -> None:
    try:
        view = camera(fov_y=40, look_at={"eye": eye, "target": target, "up": up})
    except SceneError:
        assume(False)
    again = camera(fov_y=40, world_from_camera=view.world_from_camera.tolist())
    assert again.world_from_camera.tolist() == view.world_from_camera.tolist()


@given(st.integers(-(2**20), 2**20), st.integers(-(2**20), 2**20), st.floats(2.0**-29, 1.0))
def test_an_up_near_the_view_still_gives_a_rotation(x: int, y: int, tilt: float) -> None:
    # Just this side of the limit, the pose is as far from a rotation as it gets: within 1e-6.
    view = {"eye": [x, y, 3.0], "target": [0, 0, 0], "up": [x + y * tilt, y - x * tilt, 3.0 + tilt]}
    try:
        pose = camera(fov_y=40, look_at=view).world_from_camera[:3, :3]
    except SceneError:
        assume(False)
    assert np.abs(pose.T @ pose - np.eye(3)).max() <= 1e-6


@pytest.mark.parametrize("slack", [9e-7, -9e-7])
def test_a_pose_may_miss_a_rotation_by_a_millionth(slack: float) -> None:
    pose = np.eye(4)
    pose[0, 1] = slack
    assert camera(fov_y=40, world_from_camera=pose.tolist()).world_from_camera.tolist() == pose.tolist()


def test_near_far_and_crop_arrive() -> None:
    view = camera(fov_y=40, near=1, far=1, crop=[0, 479, 640, 480])
    assert (view.near, view.far, view.crop) == (1, 1, (0, 479, 640, 480))
    assert all(type(number) is int for number in (*view.crop, view.width, view.height))
    assert type(view.near) is float
