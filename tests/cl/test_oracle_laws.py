"""Laws that the exact image and its margins obey: windows, scales, order, culling, bands."""

import copy
import itertools
from typing import Any

import numpy as np
import pytest
from flint import fmpz
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle
from tests.oracle import Truth
from tests.oracle.band import FLOAT32_BAND, HALF, normal_condition
from tests.oracle.culling import Culling
from tests.oracle.exact_quadric import ExactQuadric
from tests.oracle.hits import kept_hits, ray_form
from tests.oracle.pixel_polynomial import Linear, Quadratic, squared, times
from tests.oracle.view import View
from tests.scenes import CATALOGUE, Document, as_scene

SOME = ["crowd", "inside_a_capped_cylinder", "eight_clips", "far_away_orthographic", "back_of_a_cap"]
integer = st.integers(-(10**6), 10**6)
pixel = st.integers(-400, 400)


def same(first: Truth, second: Truth, *but: str) -> bool:
    """Equal in every field, bit by bit, but for some."""
    return all(np.array_equal(value, vars(second)[name]) for name, value in vars(first).items() if name not in but)


def image(document: Document) -> Truth:
    return oracle.image(as_scene(document))


@pytest.mark.parametrize("name", SOME)
def test_pixels_are_those_of_the_image(name: str) -> None:
    scene = as_scene(CATALOGUE[name].document)
    places = [(3, 5), (11, 8), (23, 15), (3, 5)]
    whole, some = oracle.image(scene), oracle.pixels(scene, places)
    rows, columns = [j for _, j in places], [i for i, _ in places]
    for field, values in vars(some).items():
        np.testing.assert_array_equal(values, vars(whole)[field][rows, columns])


def test_no_pixels_are_no_answers() -> None:
    assert oracle.pixels(as_scene(CATALOGUE["crowd"].document), []).normal.shape[0] == 0


@pytest.mark.parametrize("name", SOME)
def test_scaling_the_world_by_a_power_of_two_scales_the_depths(name: str) -> None:
    document = copy.deepcopy(CATALOGUE[name].document)
    scene = as_scene(document)
    factor = 0.25
    quadrics, camera = scene.quadrics, scene.camera
    placed = quadrics.world_from_object * factor
    pose = camera.world_from_camera.copy()
    pose[:3, 3] *= factor
    clip = quadrics.clip * [1, 1, 1, factor]
    orthographic = camera.projection == "orthographic"
    scaled = replaced(
        scene,
        quadrics={"world_from_object": placed, "clip": clip},
        camera={
            "world_from_camera": pose,
            "near": camera.near * factor,
            "far": camera.far * factor,
            "fx": camera.fx / factor if orthographic else camera.fx,
            "fy": camera.fy / factor if orthographic else camera.fy,
        },
    )
    here, there = oracle.image(scene), oracle.image(scaled)
    assert same(here, there, "depth", "distance", "back", "position", "margin", "back_margin")
    for field in ("depth", "distance", "back"):
        hit = here.hit
        np.testing.assert_array_equal(vars(there)[field][hit], vars(here)[field][hit] * np.float32(factor))
    np.testing.assert_array_equal(there.position, here.position * factor)


def replaced(scene: Any, **parts: dict[str, object]) -> Any:
    """A scene with some fields of some of its parts replaced."""
    fresh = {name: type(getattr(scene, name))(**{**vars(getattr(scene, name)), **new}) for name, new in parts.items()}
    return type(scene)(**{**vars(scene), **fresh})


def test_a_mirrored_scene_gives_a_mirrored_image() -> None:
    # x -> -x for world, objects and pixels; 24 columns about cx = 12.
    document = copy.deepcopy(CATALOGUE["back_of_a_cap"].document)
    here = image(document)
    scene = as_scene(document)
    placed = scene.quadrics.world_from_object * np.array([[-1.0], [1], [1]])
    clip = scene.quadrics.clip * [-1, 1, 1, 1]
    there = oracle.image(replaced(scene, quadrics={"world_from_object": placed, "clip": clip}))
    for field in ("hit", "kind", "depth", "distance", "back"):
        np.testing.assert_array_equal(vars(there)[field], vars(here)[field][:, ::-1])
    np.testing.assert_array_equal(there.normal, here.normal[:, ::-1] * [-1, 1, 1] + 0.0)


def test_document_order_matters_only_at_ties() -> None:
    document = CATALOGUE["crowd"].document
    quadrics = [{**quadric, "id": k + 1} for k, quadric in enumerate(document["quadrics"])]
    forward, backward = image({**document, "quadrics": quadrics}), image({**document, "quadrics": quadrics[::-1]})
    assert same(forward, backward, "quadric")


@pytest.mark.parametrize("factor", [-1, 3, 1e-200, 1e200])
def test_a_matrix_times_a_number_is_the_same_surface(factor: float) -> None:
    matrix = np.array([[1, 0.5, 0, 0], [0.5, 2, 0, 0], [0, 0, 1, 4], [0, 0, 4, 14]])
    quadric = {"shape": "quadric", "matrix": matrix.tolist()}
    scaled = {"shape": "quadric", "matrix": (matrix * factor).tolist()}
    camera = CATALOGUE["crop"].document["camera"]
    document = {"conicoid": 1, "camera": camera, "output": {"normal_side": "facing"}}
    here, there = image({**document, "quadrics": [quadric]}), image({**document, "quadrics": [scaled]})
    if factor in (-1, 3):
        assert same(here, there)  # times 1e±200 the entries round
    np.testing.assert_array_equal(here.hit, there.hit)


@pytest.mark.parametrize("name", ["crowd", "subpixel_spheres", "small_capped_cylinder_at_1e7", "cans_end_to_end"])
def test_culling_drops_no_quadric_that_is_hit(name: str) -> None:
    scene = as_scene(CATALOGUE[name].document)
    view = View(scene.camera)
    quadrics = [ExactQuadric(view, scene.quadrics, k) for k in range(len(scene.quadrics))]
    culling = Culling(quadrics, HALF)
    dropped = 0
    for column, row in itertools.product(range(scene.camera.width), range(0, scene.camera.height, 3)):
        i, j = 2 * column + 1, 2 * row + 1
        left = set(range(len(quadrics))) - set(culling.candidates(i, j))
        dropped += len(left)
        assert not any(kept_hits(quadrics[k], ray_form(quadrics[k], i, j), i, j) for k in left)
    assert dropped > 0


@given(st.tuples(*[integer] * 6), pixel, pixel, pixel, pixel)
def test_a_tiles_terms_are_at_most_four_times_the_pixels(
    terms: tuple[int, ...], i: int, j: int, x: int, y: int
) -> None:
    # The claim that `band` rests on, for the centre of any tile that holds the pixel.
    conic = Quadratic(*map(fmpz, terms))
    centre = i + x % (2 * HALF + 1) - HALF, j + y % (2 * HALF + 1) - HALF
    assert conic.spread(*centre, HALF) <= 4 * conic.spread(i, j, HALF)


@given(st.tuples(*[integer] * 3), st.tuples(*[integer] * 3), pixel, pixel)
def test_products_of_polynomials(first: tuple[int, ...], second: tuple[int, ...], i: int, j: int) -> None:
    p, q = Linear(*map(fmpz, first)), Linear(*map(fmpz, second))
    assert times(p, q).at(i, j) == p.at(i, j) * q.at(i, j)
    assert squared(p).at(i, j) == p.at(i, j) ** 2


def test_s_is_a_conic_of_the_pixel() -> None:
    for name in ("crowd", "orthographic_look_at"):
        scene = as_scene(CATALOGUE[name].document)
        view = View(scene.camera)
        for k in range(min(4, len(scene.quadrics))):
            quadric = ExactQuadric(view, scene.quadrics, k)
            for i, j in ((1, 1), (17, 5), (31, 23)):
                assert quadric.s.at(i, j) == ray_form(quadric, i, j).s


def test_margins_fall_to_zero_at_a_tangent_ray_and_grow_inwards() -> None:
    truth = image(CATALOGUE["tangent_rays"].document)
    # Column 12 is the axis, 5 pixels are a radius.
    margins = truth.margin[8, 7:13]
    assert margins[0] == 0
    assert np.all(np.diff(margins) > 0)
    assert margins[-1] > 0.1
    assert np.all(np.diff(truth.condition[8, 7:13]) < 0)


@pytest.mark.parametrize("bound", ["near", "far", "clip", "z_range"])
def test_margins_fall_to_zero_where_a_bound_is_the_depth(bound: str) -> None:
    # The middle ray meets the ball at depth 3, where world z = -3 and object z = 1.
    margins = []
    for gap in (0.5, 2.0**-10, 2.0**-20, 0.0, -(2.0**-20), -(2.0**-10), -0.5):
        ball: Document = {"shape": "sphere", "center": [0, 0, -4]}
        camera: Document = {"width": 1, "height": 1, "fx": 16, "fy": 16}
        if bound == "near":
            camera["near"] = 3 - gap
        elif bound == "far":
            camera["far"] = 3 + gap
        elif bound == "clip":
            ball["clip"] = [[0, 0, -1, -3 + gap]]
        else:
            ball["z_range"] = [-2, 1 + gap]
        truth = oracle.image(as_scene({"conicoid": 1, "quadrics": [ball], "camera": camera}))
        front = truth.hit.all() and truth.depth.item() == 3
        assert front == (gap >= 0)
        margins.append(truth.margin.item())
    assert margins[3] == 0
    assert margins[0] > margins[1] > margins[2] > 0 < margins[4] < margins[5] < margins[6]
    # In the band within 2^-20 of a depth of 3, out of it from 2^-10 on.
    assert max(margins[2], margins[4]) < FLOAT32_BAND < min(margins[1], margins[5])


def test_a_pixel_moved_less_than_its_margin_keeps_its_answer() -> None:
    # Moving the sample by h·2^-20 changes a polynomial by at most 2^-19 of its spread: less than the band's margin.
    document = CATALOGUE["crowd"].document
    camera = document["camera"]
    here = image(document)
    clear = here.margin >= FLOAT32_BAND
    assert clear.mean() > 0.9
    for x, y in ((1, 1), (-1, 1)):
        shift = HALF / 2 * 2.0**-21
        nudged = {**camera, "cx": camera["width"] / 2 + x * shift, "cy": camera["height"] / 2 + y * shift}
        there = image({**document, "camera": nudged})
        np.testing.assert_array_equal(there.id[clear], here.id[clear])
        np.testing.assert_array_equal(there.kind[clear], here.kind[clear])


def test_a_caps_normal_is_as_good_as_can_be() -> None:
    scene = as_scene(CATALOGUE["cylinder_end_on"].document)
    view = View(scene.camera)
    quadric = ExactQuadric(view, scene.quadrics, 0)
    form = ray_form(quadric, 25, 17)
    (first, *_) = kept_hits(quadric, form, 25, 17)
    assert normal_condition(quadric, False, form, first, 25, 17) == 1
