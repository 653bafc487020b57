"""The oracle against hits that can be worked out on paper: right triangles, apexes, discs and planes."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from tests import oracle
from tests.scenes import Document, as_scene
from tests.scenes.catalogue import document

# A ray through (3/4, 0, -1): with fx = 4 and cx = 0.5, that of column 3. It is 1.25 long per unit of depth.
COLUMN = 3
LENGTH = 1.25


class Answer(NamedTuple):
    """The oracle's answer for one pixel."""

    hit: bool
    id: int
    kind: int
    depth: float
    distance: float
    back: float
    normal: NDArray[np.float64]
    position: NDArray[np.float64]


def only(truth: oracle.Truth) -> Answer:
    (hit,), (id_,), (kind,) = truth.hit.tolist(), truth.id.tolist(), truth.kind.tolist()
    (depth,), (distance,), (back,) = truth.depth.tolist(), truth.distance.tolist(), truth.back.tolist()
    return Answer(hit, id_, kind, depth, distance, back, truth.normal[0], truth.position[0])


def truth(quadrics: list[Document], column: int = COLUMN, camera: Document | None = None, **output: object) -> Answer:
    lens = {"width": 9, "height": 1, "fx": 4, "fy": 4, "cx": 0.5, "cy": 0.5, **(camera or {})}
    return only(oracle.pixels(as_scene(document(quadrics, lens, **output)), [(column, 0)]))


def parallel(quadrics: list[Document], x: float, camera: Document | None = None, **output: object) -> Answer:
    """One ray from (x, 0, 0) along -z."""
    lens = {"projection": "orthographic", "width": 1, "height": 1, "fx": 1, "fy": 1, "cx": 0.5 - x, "cy": 0.5}
    return only(oracle.pixels(as_scene(document(quadrics, {**lens, **(camera or {})}, **output)), [(0, 0)]))


def ball(z: float, radius: float, **keys: object) -> Document:
    return {"shape": "sphere", "center": [0, 0, z], "radius": radius, **keys}


# The ray leaves a centre at (0, 0, -10) at a distance of 6, after 8 along the ray (3-4-5, doubled).
@pytest.mark.parametrize(
    ("radius", "first", "last"),
    [(6, 8, 8), (6.5, 5.5, 10.5), (7.5, 3.5, 12.5), (10, 16, 16)],
    ids=["tangent", "5-12-13", "9-12-15", "eye on the surface"],
)
def test_depths_of_a_ball_by_pythagoras(radius: float, first: float, last: float) -> None:
    got = truth([ball(-10, radius)])
    assert got.hit
    assert got.distance == first
    assert got.depth == np.float32(first / LENGTH)
    assert got.back == np.float32(last / LENGTH)
    expected = np.array([0.6, 0, -0.8]) * first
    np.testing.assert_allclose(got.position, expected, atol=1e-15 * first)
    outward = (expected - [0, 0, -10]) / radius
    side = 1 if outward @ [0.6, 0, -0.8] <= 1e-9 else -1
    np.testing.assert_allclose(got.normal, side * outward, atol=1e-15)


def test_a_hair_less_than_tangent_misses() -> None:
    assert not truth([ball(-10, math.nextafter(6, 0))]).hit
    assert truth([ball(-10, math.nextafter(6, 7))]).hit


def test_near_and_far_are_closed_and_pick_the_second_root() -> None:
    quadric = ball(-10, 7.5)  # roots 2.8 and 10; 2.8 is no binary64
    assert truth([quadric], camera={"near": 2.75, "far": 10}).back == 10
    assert truth([quadric], camera={"near": 3, "far": 10}).depth == 10
    assert not truth([quadric], camera={"near": 3, "far": math.nextafter(10, 0)}).hit
    assert not truth([quadric], camera={"near": math.nextafter(10, 11)}).hit


def test_a_cone_is_hit_at_its_apex_with_no_gradient() -> None:
    cone = {"shape": "cone", "center": [3, 0, -4]}
    got = truth([cone])
    assert (got.hit, got.depth, got.back) == (True, 4, 4)
    # Back along the ray: -(3/4, 0, -1)/1.25.
    np.testing.assert_allclose(got.normal, [-0.6, 0, 0.8], atol=1e-16)


def test_a_cylinder_end_on_is_its_cap() -> None:
    can = {"shape": "cylinder", "center": [0, 0, -5], "z_range": [-1, 1], "capped": True}
    for x, hit in ((0, True), (1, True), (-1, True), (1.0000000000000002, False)):
        got = parallel([can], x)
        assert got.hit == hit
        if hit:
            assert (got.kind, got.depth, got.back) == (2, 4, 6)
            assert got.normal.tolist() == [0, 0, 1]
    bare = {"shape": "cylinder", "center": [0, 0, -5]}
    assert not parallel([bare], 1).hit


def test_a_cap_from_behind_faces_the_eye_or_not_as_asked() -> None:
    can = {"shape": "cylinder", "center": [0, 0, -5], "z_range": [-1, 7], "capped": True}
    assert parallel([can], 0.5).normal.tolist() == [0, 0, 1]
    got = parallel([can], 0.5, normal_side="outward")
    assert (got.kind, got.depth) == (1, 6)
    assert got.normal.tolist() == [0, 0, -1]


def test_a_cap_seen_edge_on_is_missed() -> None:
    turned = {"shape": "cylinder", "center": [0, 0, -5], "rotation": [1, 0, 0, 1], "z_range": [0, 1], "capped": True}
    got = parallel([turned], 0.6)
    assert (got.kind, got.depth, got.back) == (0, float(np.float32(4.2)), float(np.float32(5.8)))


def test_a_ray_along_a_wall_meets_only_the_caps() -> None:
    # f = 0 all along: the surface is missed, the closed discs are not.
    can = {"shape": "cylinder", "center": [0, 0, -5], "z_range": [-1, 1], "capped": True, "id": 9}
    got = parallel([can], 1)
    assert (got.id, got.kind, got.depth, got.back) == (9, 2, 4, 6)


def test_the_surface_comes_before_a_cap_at_the_same_depth() -> None:
    # The rim at object z = 1 of a unit cone, reached by a ray that enters there.
    cone = {"shape": "cone", "center": [0, 0, -5], "z_range": [-1, 1], "capped": True}
    got = truth([{**cone, "center": [3 - 1, 0, -4 - 1]}])
    assert (got.kind, got.depth) == (0, 4)


def test_the_cap_at_z0_comes_before_the_cap_at_z1() -> None:
    disc = {"shape": "sphere", "center": [0, 0, -5], "z_range": [0, 0], "capped": True}
    got = parallel([disc], 0.5, normal_side="outward")
    assert (got.kind, got.depth, got.back) == (1, 5, 5)
    assert got.normal.tolist() == [0, 0, -1]


def test_equal_depths_go_to_the_earlier_quadric() -> None:
    for first, second in ((0, 1), (1, 0)):
        quadrics = [{"shape": "plane", "center": [0, 0, -5], "id": 7}, {**ball(-6, 1), "id": 3}]
        got = parallel([quadrics[first], quadrics[second]], 0)
        assert got.id == (7, 3)[first]


def test_a_plane_at_an_angle() -> None:
    # z = -x/2 - 4: the ray t·(3/4, 0, -1) meets it at t = 4/(1 - 3/8) = 6.4.
    plane = {"shape": "quadric", "coefficients": [0, 0, 0, 0.25, 0, 0, 0, 0, 0.5, 4]}
    got = truth([plane], normal_side="outward")
    assert got.depth == got.back == np.float32(6.4)
    assert got.distance == 8
    np.testing.assert_allclose(got.normal, np.array([0.5, 0, 1]) / math.hypot(0.5, 1), atol=1e-16)


def test_a_double_plane_is_hit_and_has_no_gradient() -> None:
    plane = {"shape": "quadric", "coefficients": [0, 0, 0, 0, 0, 0, 0, 1, 4, 16]}  # (z + 4)²
    got = truth([plane])
    assert got.depth == got.back == 4
    np.testing.assert_allclose(got.normal, [-0.6, 0, 0.8], atol=1e-16)


def test_what_has_no_points_is_not_hit() -> None:
    for coefficients in (
        [1, 0, 0, 0, 1, 0, 0, 1, 0, 1],
        [0, 0, 0, 0, 0, 0, 0, 0, 0, 1],
        [1, 0, 0, 0, 0, 0, 0, 0, 0, 1],
    ):
        assert not truth([{"shape": "quadric", "coefficients": coefficients}]).hit


def test_a_line_and_a_point_are_hit_by_the_rays_that_meet_them() -> None:
    line = {"shape": "quadric", "coefficients": [1, 0, 0, 0, 0, 0, 0, 1, 0, 0], "center": [3, 0, -4]}
    point = {"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, 0], "center": [3, 0, -4]}
    for quadric in (line, point):
        assert truth([quadric]).depth == 4
        assert not truth([quadric], column=2).hit


def test_clips_are_closed_and_cut_caps_too() -> None:
    can = {"shape": "cylinder", "center": [0, 0, -5], "z_range": [-1, 1], "capped": True}
    assert parallel([{**can, "clip": [[1, 0, 0, -0.5]]}], 0.5).hit
    assert not parallel([{**can, "clip": [[1, 0, 0, -0.5]]}], 0.25).hit
    assert parallel([{**can, "clip": [[0, 0, -1, -5]]}], 0.25).kind == 1


def test_depth_is_exact_where_binary64_has_no_digit_of_the_radius() -> None:
    # A ball of 2^-4 at 2^24: |C|² - r² has a part 2^-56 of |C|². The middle ray enters at 2^24 - 2^-4.
    got = parallel([ball(-(2.0**24), 2.0**-4)], 0)
    assert got.depth == np.float32(2.0**24)
    assert parallel([ball(-(2.0**24), 2.0**-4)], 2.0**-4).hit
    assert not parallel([ball(-(2.0**24), 2.0**-4)], 2.0**-4 + 2.0**-54).hit


def test_a_normal_of_a_sheared_plane_goes_by_the_inverse_transpose() -> None:
    # z_object = z_world + 4 - x_world: normal (-1, 0, 1).
    rows = [[1, 0, 0, 0], [0, 1, 0, 0], [1, 0, 1, -4], [0, 0, 0, 1]]
    got = parallel([{"shape": "plane", "transform": rows}], 0.5, normal_side="outward")
    assert got.depth == 3.5
    np.testing.assert_allclose(got.normal, np.array([-1, 0, 1]) / math.sqrt(2), atol=1e-16)


def test_a_depth_beyond_float32_is_inf_and_still_a_hit() -> None:
    got = parallel([ball(-4e39, 1e39)], 0)
    assert (got.hit, got.depth, got.distance) == (True, math.inf, math.inf)
