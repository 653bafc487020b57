"""`worldToCamera` and `worldToNDC` send world points where the camera sees them."""

import json
import re
from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from conicoid.document import parse
from conicoid.scene import Camera
from conicoid_service.camera_matrices import world_to_camera, world_to_ndc
from tests.checkout import ROOT
from tests.service.scenes import seen_from

Projection = Literal["pinhole", "orthographic"]
PROJECTIONS: tuple[Projection, ...] = ("pinhole", "orthographic")
# Cameras below make points of at most 128 a coordinate and matrices of at most 4 an entry, 192 in the last row: the
# terms that make an NDC coordinate sum up to less than 2048, each wrong by one float32 rounding; w is at least 1.
TOLERANCE = 2048 * 2.0**-24


def rotation(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Rodrigues' formula; a rotation matrix within a few ulp, which is all that a document asks for."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: NDArray[np.float64] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    number = st.floats(-16, 16, allow_nan=False)
    axis = np.array(draw(st.tuples(number, number, number).filter(lambda a: np.linalg.norm(a) > 0.1)))
    pose = np.eye(4)
    pose[:3, :3] = rotation(axis, draw(st.floats(0, 7)))
    pose[:3, 3] = draw(st.tuples(number, number, number))
    width, height = draw(st.integers(1, 4000)), draw(st.integers(1, 4000))
    return seen_from(
        projection=draw(st.sampled_from(PROJECTIONS)),
        width=width,
        height=height,
        fx=width * draw(st.floats(0.5, 2)),
        fy=height * draw(st.floats(0.5, 2)),
        cx=width * draw(st.floats(-1, 2)),
        cy=height * draw(st.floats(-1, 2)),
        world_from_camera=pose,
    )


def on_ray(camera: Camera, u: float, v: float, depth: float) -> NDArray[np.float64]:
    """The world point at planar depth `depth` on the ray through (u, v), by the contract's formula."""
    x, y = (u - camera.cx) / camera.fx, -(v - camera.cy) / camera.fy
    scale = depth if camera.projection == "pinhole" else 1.0
    point: NDArray[np.float64] = camera.world_from_camera @ [x * scale, y * scale, -depth, 1]
    return point


@given(cameras(), st.floats(0, 1), st.floats(0, 1), st.floats(1, 16))
def test_a_point_on_a_pixels_ray_projects_to_that_pixel(camera: Camera, x: float, y: float, depth: float) -> None:
    point = on_ray(camera, x * camera.width, y * camera.height, depth)
    projected = point @ world_to_ndc(camera).astype(np.float64)
    assert projected[:2] / projected[3] == pytest.approx((x, y), abs=TOLERANCE)
    z = projected[2] / projected[3]
    assert z == pytest.approx(1 / depth if camera.projection == "pinhole" else depth, rel=TOLERANCE, abs=TOLERANCE)


@given(cameras(), st.floats(-1, 1), st.floats(-1, 1), st.floats(1, 16))
def test_camera_space_is_left_handed_and_looks_along_plus_z(camera: Camera, x: float, y: float, depth: float) -> None:
    point = camera.world_from_camera @ [x, y, -depth, 1]
    assert point @ world_to_camera(camera).astype(np.float64) == pytest.approx((x, y, depth, 1), abs=TOLERANCE)
    assert np.linalg.det(world_to_camera(camera)[:3, :3]) == pytest.approx(-1, abs=TOLERANCE)


def test_a_camera_far_away_loses_nothing_but_the_last_rounding() -> None:
    pose = np.eye(4)
    pose[:3, :3] = rotation(np.array([1.0, 2.0, 3.0]), 1.0)
    pose[:3, 3] = [1e7, -2e7, 3e7]
    expected = -(np.linalg.inv(pose[:3, :3]) @ pose[:3, 3]) * [1, 1, -1]
    # Half an ulp of float32 at 4e7 is 2.
    assert world_to_camera(seen_from(world_from_camera=pose))[3, :3] == pytest.approx(expected, abs=2)


def test_entries_beyond_binary32_are_infinite_not_an_error() -> None:
    pose = np.eye(4)
    pose[0, 3] = 1e300
    assert world_to_camera(seen_from(world_from_camera=pose))[3, 0] == -np.inf


def test_the_documented_example_is_true() -> None:
    text = (ROOT / "docs/exr.md").read_text("utf-8")
    described, to_camera, to_ndc = map(json.loads, re.findall(r"```json\n(.*?)```", text, re.DOTALL))
    camera = parse(json.dumps({"conicoid": 1, "quadrics": [], "camera": described}).encode()).resolve().camera
    assert world_to_camera(camera).tolist() == to_camera
    assert world_to_ndc(camera).tolist() == to_ndc
    point = np.array([2, 21, 32, 1])
    assert (point @ to_camera).tolist() == [1, 2, 8, 1]
    assert (point @ to_ndc).tolist() == [4.25, 0.5, 1, 8]
    assert on_ray(camera, 340, 30, 8).tolist() == point.tolist()
