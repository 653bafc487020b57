"""The host's exact pixels against answers worked out on paper."""

import math

import numpy as np
import pytest

from conicoid.exact import CAP_HIGH, CAP_LOW, SURFACE
from tests.cl.exact_pixels import ORTHOGRAPHIC, PINHOLE, exact_scene, hit, solve, values
from tests.scenes import Document

BALL: Document = {"shape": "sphere", "center": [0, 0, -10], "radius": 5}
CAN: Document = {"shape": "cylinder", "center": [0, 0, -10], "radius": 2, "z_range": [-1, 1], "capped": True}
PLANE: Document = {"shape": "plane", "center": [0, 0, -9]}
# Object z points along the world's y: rays of the first row lie in the planes of constant object z.
EDGE_ON: Document = {"transform": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -10], [0, 0, 0, 1]]}
# Rays (k/4, 0, -1): column 3 makes a 3-4-5 triangle, 5/4 long per unit of depth.
QUARTERS: Document = {**PINHOLE, "fx": 4}


def single(value: float) -> float:
    return float(np.float32(value))


def multiple(value: float, exponent: int = -23) -> float:
    """The nearest multiple of 2^exponent."""
    return math.ldexp(round(math.ldexp(value, -exponent)), exponent)


def test_right_triangle_within_a_ball() -> None:
    pixel = hit([BALL], ORTHOGRAPHIC, i=3)
    assert (pixel.quadric, pixel.kind) == (0, SURFACE)
    assert (pixel.z, pixel.t, pixel.z_back) == (6, 6, 14)
    assert [*pixel.position, *pixel.normal] == [3, 0, -6, multiple(0.6), 0, multiple(0.8)]


def test_outward_normal_within_a_ball_points_away_from_its_centre() -> None:
    inside = {**BALL, "center": [0, 0, 0]}
    assert hit([inside], ORTHOGRAPHIC, i=3, normal_side="outward").normal == (multiple(0.6), 0, multiple(-0.8))
    assert hit([inside], ORTHOGRAPHIC, i=3, normal_side="facing").normal == (multiple(-0.6), 0, multiple(0.8))


def test_tangent_ray_hits_once_with_the_outward_normal() -> None:
    pixel = hit([BALL], ORTHOGRAPHIC, i=5)
    assert (pixel.z, pixel.z_back, pixel.normal) == (10, 10, (1, 0, 0))


@pytest.mark.parametrize(("radius", "hits"), [(math.nextafter(5, 0), False), (5.0, True), (math.nextafter(5, 6), True)])
def test_last_bit_of_the_radius_decides_a_tangent_ray(radius: float, hits: bool) -> None:
    assert (solve([{**BALL, "radius": radius}], ORTHOGRAPHIC, i=5) is not None) == hits


def test_tangent_from_the_eye_of_a_pinhole() -> None:
    """A ball of radius 3 at 5: the tangent is 4 long, and 4 · 4/5 deep."""
    pixel = hit([{**BALL, "center": [0, 0, -5], "radius": 3}], QUARTERS, i=3)
    assert (pixel.z, pixel.t) == (single(3.2), 4)
    assert [*pixel.position] == [multiple(2.4, -22), 0, multiple(-3.2, -22)]
    assert [*pixel.normal] == [multiple(0.8), 0, multiple(0.6)]


def test_plane_at_a_slant_of_the_ray() -> None:
    pixel = hit([PLANE], QUARTERS, i=3)
    assert (pixel.z, pixel.t, pixel.position, pixel.normal) == (9, 11.25, (6.75, 0, -9), (0, 0, 1))


def test_normal_in_camera_space_turns_with_the_camera() -> None:
    sideways = [[0, 0, 1, 10], [0, 1, 0, 0], [-1, 0, 0, -10], [0, 0, 0, 1]]
    camera = {**ORTHOGRAPHIC, "world_from_camera": sideways}
    assert hit([BALL], camera, i=3).normal == (multiple(0.8), 0, multiple(-0.6))
    assert hit([BALL], camera, i=3, normal_space="camera").normal == (multiple(0.6), 0, multiple(0.8))


@pytest.mark.parametrize("side", ["facing", "outward"])
@pytest.mark.parametrize("space", ["world", "camera"])
def test_vanishing_gradient_is_shaded_back_along_the_ray(space: str, side: str) -> None:
    apex = {"shape": "cone", "center": [3, 0, -4]}
    pixel = hit([apex], QUARTERS, i=3, normal_space=space, normal_side=side)
    assert (pixel.z, pixel.t, pixel.normal) == (4, 5, (multiple(-0.6), 0, multiple(0.8)))
    double_plane = {"shape": "quadric", "coefficients": [0, 0, 0, 0, 0, 0, 0, 1, 8, 64]}
    pixel = hit([double_plane], QUARTERS, i=3, normal_space=space, normal_side=side)
    assert (pixel.z, pixel.z_back, pixel.normal) == (8, 8, (multiple(-0.6), 0, multiple(0.8)))


def test_point_and_line_are_hit_only_by_the_rays_through_them() -> None:
    point = {"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, 0], "center": [3, 0, -4]}
    line = {"shape": "quadric", "coefficients": [1, 0, 0, 0, 0, 0, 0, 1, 0, 0], "center": [3, 0, -4]}
    empty = {"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, 1], "center": [3, 0, -4]}
    assert [solve([point], QUARTERS, i, j) is not None for i, j in ((3, 0), (2, 0), (3, 1))] == [True, False, False]
    assert [solve([line], QUARTERS, i, j) is not None for i, j in ((3, 0), (2, 0), (3, 1))] == [True, False, True]
    assert solve([empty], QUARTERS, 3) is None


def test_cylinder_seen_end_on_shows_its_caps_alone() -> None:
    pixel = hit([CAN], ORTHOGRAPHIC, i=1)
    assert (pixel.kind, pixel.z, pixel.z_back, pixel.normal) == (CAP_HIGH, 9, 11, (0, 0, 1))
    assert solve([{**CAN, "capped": False}], ORTHOGRAPHIC, i=1) is None


def test_ray_in_the_wall_of_a_can_misses_the_wall_and_hits_the_rim() -> None:
    pixel = hit([CAN], ORTHOGRAPHIC, i=2)
    assert (pixel.kind, pixel.z) == (CAP_HIGH, 9)
    assert solve([CAN], ORTHOGRAPHIC, i=3) is None


def test_can_from_behind_shows_the_cap_at_its_lower_end() -> None:
    turned = {**CAN, "rotation": [1, 0, 0, 0]}
    pixel = hit([turned], ORTHOGRAPHIC, i=1, normal_side="outward")
    assert (pixel.kind, pixel.z, pixel.normal) == (CAP_LOW, 9, (0, 0, 1))
    inside = hit([{**turned, "center": [0, 0, 0]}], ORTHOGRAPHIC, i=1, normal_side="outward")
    assert (inside.kind, inside.z, inside.normal) == (CAP_HIGH, 1, (0, 0, -1))


def test_ray_within_a_plane_misses_it() -> None:
    assert solve([{"shape": "plane", **EDGE_ON}], ORTHOGRAPHIC, j=0) is None
    assert solve([{"shape": "parallel_planes", **EDGE_ON}], ORTHOGRAPHIC, j=1) is None
    assert solve([{"shape": "plane", **EDGE_ON}], {**PINHOLE, "fy": 2}, j=0) is None


def test_ray_within_the_plane_of_a_cap_misses_the_cap_but_not_the_wall() -> None:
    slab = {"shape": "cylinder", "radius": 2, "z_range": [0, 1], "capped": True, **EDGE_ON}
    pixel = hit([slab], ORTHOGRAPHIC, j=0)
    assert (pixel.kind, pixel.z, pixel.z_back) == (SURFACE, 8, 12)


def test_equal_depths_go_to_the_earlier_quadric() -> None:
    assert hit([CAN, PLANE], ORTHOGRAPHIC).quadric == 0
    assert hit([PLANE, CAN], ORTHOGRAPHIC).quadric == 0
    assert hit([{**PLANE, "center": [0, 0, -9.5]}, PLANE, CAN, PLANE], ORTHOGRAPHIC).quadric == 1


def test_equal_depths_within_a_quadric_go_to_the_surface_then_to_the_lower_cap() -> None:
    apex = {"shape": "cone", "center": [0, 0, -9], "z_range": [-1, 0], "capped": True}
    assert hit([apex], ORTHOGRAPHIC).kind == SURFACE
    disc = {**CAN, "z_range": [0, 0]}
    pixel = hit([disc], ORTHOGRAPHIC)
    assert (pixel.kind, pixel.z, pixel.z_back, pixel.normal) == (CAP_LOW, 10, 10, (0, 0, 1))
    assert hit([disc], ORTHOGRAPHIC, normal_side="outward").normal == (0, 0, -1)


def test_irrational_depths_are_equal_where_their_surds_are() -> None:
    """sqrt(8) behind one centre is 2 sqrt(2) behind the same; a radius one bit larger is in front."""
    ellipsoid = {"shape": "ellipsoid", "radii": [3, 3, 3], "center": [0, 0, -10]}
    matrix = {"shape": "quadric", "matrix": np.diag([7.0, 7, 7, -63]).tolist(), "center": [0, 0, -10]}
    larger = {**BALL, "radius": math.nextafter(3, 4)}
    assert hit([ellipsoid, matrix, {**BALL, "radius": 3}], ORTHOGRAPHIC, i=1).quadric == 0
    assert hit([ellipsoid, matrix, larger], ORTHOGRAPHIC, i=1).quadric == 2


def test_near_and_far_are_closed() -> None:
    assert hit([BALL], {**ORTHOGRAPHIC, "near": 6, "far": 6}, i=3).z == 6
    assert hit([BALL], {**ORTHOGRAPHIC, "near": math.nextafter(6, 7)}, i=3).z == 14
    assert solve([BALL], {**ORTHOGRAPHIC, "far": math.nextafter(6, 5)}, i=3) is None
    assert hit([BALL], {**ORTHOGRAPHIC, "far": 13}, i=3).z_back == 6


def test_depth_zero_is_never_kept() -> None:
    at_the_eye = {**BALL, "center": [0, 0, -5]}
    assert hit([at_the_eye], ORTHOGRAPHIC).z == 10
    assert solve([{**BALL, "center": [0, 0, 5]}], ORTHOGRAPHIC) is None
    assert solve([{"shape": "plane"}], PINHOLE) is None


def test_extent_and_clips_are_closed() -> None:
    upper = {**BALL, "z_range": [4, 4]}
    assert hit([upper], ORTHOGRAPHIC, i=3).z == 6
    assert solve([{**BALL, "z_range": [math.nextafter(4, 5), 5]}], ORTHOGRAPHIC, i=3) is None
    assert hit([{**BALL, "clip": [[0, 0, 1, 6], [-1, 0, 0, 3]]}], ORTHOGRAPHIC, i=3).z == 6
    assert hit([{**BALL, "clip": [[0, 0, -1, -7]]}], ORTHOGRAPHIC, i=3).z == 14


def test_caps_are_clipped_too() -> None:
    half = {**CAN, "clip": [[-1, 0, 0, 1]]}
    assert hit([half], ORTHOGRAPHIC, i=1).z == 9
    assert hit([{**CAN, "clip": [[0, 0, -1, -10]]}], ORTHOGRAPHIC, i=1).z == 11
    assert solve([half], ORTHOGRAPHIC, i=2) is None


def test_last_hit_of_the_winner_may_be_a_cap() -> None:
    bowl = {**BALL, "z_range": [-3, 5], "capped": True}
    pixel = hit([bowl], ORTHOGRAPHIC, i=0)
    assert (pixel.kind, pixel.z, pixel.z_back) == (SURFACE, 5, 13)


def test_candidates_alone_are_seen() -> None:
    scene = exact_scene([PLANE, BALL], ORTHOGRAPHIC)
    assert scene.pixel(3, 0, [0, 1]) is not None
    assert getattr(scene.pixel(3, 0, [1]), "z", None) == 6
    assert getattr(scene.pixel(3, 0, [0]), "z", None) == 9
    assert scene.pixel(3, 0, []) is None


def test_values_are_named_as_planes() -> None:
    scene = exact_scene([{**PLANE, "id": 77, "clip": [[-1, 0, 0, 4]]}], ORTHOGRAPHIC, background_depth=1e300)
    names = ["Z", "T", "ZBack", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "id", "A"]
    seen, missed = (values(scene, i, 0, [0]) for i in (4, 5))
    assert list(seen) == list(missed) == names
    assert list(seen.values()) == [9, 9, 9, 0, 0, 1, 4, 0, -9, 77, 1]
    assert list(missed.values()) == [math.inf] * 3 + [0] * 8
