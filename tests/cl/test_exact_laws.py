"""What may be done to a scene without changing its exact pixels."""

import itertools
import random

import pytest

from tests.cl.exact_pixels import exact_scene, values
from tests.scenes import Document
from tests.scenes.catalogue import either

DEPTHS = {"Z", "T", "ZBack"}
PLACES = {"P.X", "P.Y", "P.Z"}


def dyadic(draw: random.Random, low: float, high: float) -> float:
    """A multiple of 2^-12: sums with integers up to 2^30 and products with powers of two are exact."""
    return round(draw.uniform(low, high) * 4096) / 4096


def random_quadrics(seed: int) -> list[Document]:
    """Closed and open shapes with extents, caps and clips, about (0, 0, -4)."""
    draw = random.Random(seed)
    quadrics: list[Document] = []
    for shape in ("sphere", "cylinder", "hyperboloid_one_sheet", "ellipsoid", "hyperboloid_two_sheets"):
        radii = [dyadic(draw, 0.25, 1.5) for _ in range(3)]
        size = {"radius": radii[0]} if shape == "sphere" else {"radii": radii[: 2 if shape == "cylinder" else 3]}
        linear = [[dyadic(draw, -1, 1) + (k == m) for m in range(3)] for k in range(3)]
        place = [dyadic(draw, -1.5, 1.5), dyadic(draw, -1, 1), dyadic(draw, -5, -3)]
        transform = [[*row, x] for row, x in zip(linear, place, strict=True)]
        quadrics.append({"shape": shape, "transform": [*transform, [0, 0, 0, 1]], **size})
    quadrics[1] |= {"z_range": [-0.5, 0.75], "capped": True, "clip": [[1, 0.5, 0, 0.25]]}
    quadrics[2] |= {"z_range": [-0.5, 0.25], "capped": True}
    quadrics[4] |= {"z_range": [-2, 2]}
    return quadrics


def changed(quadric: Document, scale: float, shift: list[float]) -> Document:
    """The quadric scaled about the origin by a power of two, then moved."""
    rows = quadric["transform"][:3]
    moved = [[*(scale * x for x in row[:3]), scale * row[3] + by] for row, by in zip(rows, shift, strict=True)]
    clips = [
        [*c[:3], scale * c[3] - sum(x * by for x, by in zip(c, shift, strict=False))] for c in quadric.get("clip", [])
    ]
    return {**quadric, "transform": [*moved, [0, 0, 0, 1]], **({"clip": clips} if clips else {})}


def pose(shift: list[float]) -> list[list[float]]:
    return [[1, 0, 0, shift[0]], [0, 1, 0, shift[1]], [0, 0, 1, shift[2]], [0, 0, 0, 1]]


PIXELS = list(itertools.product(range(1, 24, 4), range(1, 16, 4)))
CASES = pytest.mark.parametrize(("projection", "seed"), [*itertools.product(("pinhole", "orthographic"), (1, 2, 3))])


def image(quadrics: list[Document], camera: Document, order: list[int], **output: object) -> list[dict[str, float]]:
    scene = exact_scene(quadrics, camera, **output)
    return [values(scene, i, j, order) for i, j in PIXELS]


@CASES
def test_moving_scene_and_camera_together_moves_only_positions(projection: str, seed: int) -> None:
    shift = [2.0**20, -(2.0**19), 3.0]
    quadrics, order = random_quadrics(seed), [*range(5)]
    still = image(quadrics, either(projection), order)
    moved = image([changed(quadric, 1, shift) for quadric in quadrics],
                  either(projection, world_from_camera=pose(shift)), order)  # fmt: skip
    assert any(pixel["A"] for pixel in still)
    for before, after in zip(still, moved, strict=True):
        assert {k: v for k, v in before.items() if k not in PLACES} == {
            k: v for k, v in after.items() if k not in PLACES
        }


@pytest.mark.parametrize("power", [-60, 7, 60])
@CASES
def test_scaling_everything_by_a_power_of_two_scales_depths_and_positions(
    projection: str, seed: int, power: int
) -> None:
    scale = 2.0**power
    quadrics, order = random_quadrics(seed), [*range(5)]
    camera = {**either(projection), "near": 3.25, "far": 5.5}
    larger = {**camera, "near": 3.25 * scale, "far": 5.5 * scale}
    if projection == "orthographic":
        larger["view_height"] *= scale
    plain = image(quadrics, camera, order)
    scaled = image([changed(quadric, scale, [0, 0, 0]) for quadric in quadrics], larger, order)
    for before, after in zip(plain, scaled, strict=True):
        assert {k: v * scale if k in DEPTHS | PLACES else v for k, v in before.items()} == after


@pytest.mark.parametrize("power", [-900, -1022, 900])
def test_ids_and_normals_survive_scales_beyond_binary32(power: int) -> None:
    """Transforms down to subnormal binary64; the scale is a power of two, so all are exact."""
    scale = 2.0**power
    quadrics = [{"shape": "sphere", "radius": 0.75, "transform": pose([x, 0.25, -4])} for x in (-0.5, 0, 0.5)]
    plain = image(quadrics, either("pinhole"), [0, 1, 2])
    scaled = image([changed(quadric, scale, [0, 0, 0]) for quadric in quadrics], either("pinhole"), [0, 1, 2])
    assert any(pixel["A"] for pixel in plain)
    for before, after in zip(plain, scaled, strict=True):
        for name in ("id", "A", "N.X", "N.Y", "N.Z"):
            assert before[name] == after[name]


@CASES
def test_order_and_repetition_of_candidates_do_not_matter(projection: str, seed: int) -> None:
    quadrics = random_quadrics(seed)
    quadrics += [quadrics[0], {**quadrics[1], "capped": False}]
    expected = image(quadrics, either(projection), [0, 1, 2, 3, 4, 5, 6])
    assert image(quadrics, either(projection), [6, 3, 5, 0, 4, 1, 2, 2, 6]) == expected


@pytest.mark.parametrize("factor", [3.0, -1.0])
@CASES
def test_multiplying_a_form_by_a_number_changes_nothing(projection: str, seed: int, factor: float) -> None:
    draw = random.Random(seed)
    terms = [dyadic(draw, -1, 1) for _ in range(10)]
    forms = [{"shape": "quadric", "coefficients": [k * x for x in terms], "center": [0, 0, -4]} for k in (1, factor)]
    plain, multiplied = (image([form], either(projection), [0]) for form in forms)
    assert any(pixel["A"] for pixel in plain)
    assert plain == multiplied


@CASES
def test_outward_normal_is_the_facing_one_or_its_opposite(projection: str, seed: int) -> None:
    quadrics, order = random_quadrics(seed), [*range(5)]
    facing, outward = (image(quadrics, either(projection), order, normal_side=side) for side in ("facing", "outward"))
    signs = set()
    for one, other in zip(facing, outward, strict=True):
        if one["A"]:
            pairs = [(one[name], other[name]) for name in ("N.X", "N.Y", "N.Z")]
            same = all(x == y for x, y in pairs)
            assert same or all(x == -y for x, y in pairs)
            signs.add(same)
    assert signs
