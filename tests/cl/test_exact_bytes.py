"""What must not change the bytes of an `exact` image, or must change them in one known way."""

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from conicoid.engine import Renderer
from tests.scenes import CATALOGUE, as_scene
from tests.scenes.catalogue import CHANNELS, PROJECTIONS, Document, document
from tests.scenes.stress_catalogue import STRESS
from tests.scenes.stress_mix import Mix

Planes = dict[str, NDArray[Any]]

MIXED = [*(f"mix_{seed}" for seed in range(10)), "coincident_parts_pinhole", "coincident_wholes_orthographic"]
SCENES = {**{name: scene.document for name, scene in CATALOGUE.items()},
          **{name: scene.document for name, scene in STRESS.items()}}  # fmt: skip
SEEDS = st.integers(0, 10_000)


@pytest.fixture(scope="module")
def planes_of(renderer: Renderer) -> Callable[[Document], Planes]:
    def render(body: Document) -> Planes:
        return {name: plane.copy() for name, plane in renderer.render(as_scene(body)).planes.items()}

    return render


def assert_same_bytes(first: Planes, second: Planes) -> None:
    assert first.keys() == second.keys()
    for name, plane in first.items():
        assert plane.tobytes() == second[name].tobytes(), name


def drawn(seed: int, count: int = 6, width: int = 32, height: int = 24) -> Document:
    quadrics, camera, sides = Mix(seed).scene(count, PROJECTIONS[seed % 2], width, height)
    return document(quadrics, camera, **sides)


def scaled(original: Document, exponent: int) -> Document:
    """The world times 2^exponent, where nothing rounds. Object space is scaled by transforms alone."""
    body = copy.deepcopy(original)
    factor = 2.0**exponent
    for quadric in body["quadrics"]:
        rows = as_scene({**original, "quadrics": [quadric]}).quadrics.world_from_object[0]
        for key in ("center", "rotation"):
            quadric.pop(key, None)
        quadric["transform"] = [*(rows * factor).tolist(), [0, 0, 0, 1]]
        if "clip" in quadric:
            quadric["clip"] = [[*clip[:3], clip[3] * factor] for clip in quadric["clip"]]
    camera = as_scene(original).camera
    pose = camera.world_from_camera.copy()
    pose[:3, 3] *= factor
    lens = 1 / factor if camera.projection == "orthographic" else 1.0
    body["camera"] = {
        "projection": camera.projection, "width": camera.width, "height": camera.height, "fx": camera.fx * lens,
        "fy": camera.fy * lens, "cx": camera.cx, "cy": camera.cy, "world_from_camera": pose.tolist(),
        "near": camera.near * factor, "crop": list(camera.crop),
    }  # fmt: skip
    if np.isfinite(camera.far):
        body["camera"]["far"] = camera.far * factor
    return body


@settings(max_examples=12)
@given(seed=SEEDS, exponent=st.integers(-60, 60))
def test_a_world_times_a_power_of_two_has_the_same_image(
    seed: int, exponent: int, planes_of: Callable[[Document], Planes]
) -> None:
    here = planes_of(scaled(drawn(seed), 0))
    there = planes_of(scaled(drawn(seed), exponent))
    for name, plane in there.items():
        if name in {"Z", "T", "ZBack", "P.X", "P.Y", "P.Z"}:
            # Depths near 5 times 2^±60 stay normal numbers of float32; components of P may be tiny, and not.
            there[name] = np.ldexp(plane.astype(np.float64), -exponent)
            here[name] = here[name].astype(np.float64)
    for name in ("P.X", "P.Y", "P.Z"):
        keep = np.abs(here[name]) > 2.0**-60
        here[name], there[name] = here[name][keep], there[name][keep]
    assert_same_bytes(here, there)


@settings(max_examples=12)
@given(seed=SEEDS, step=st.tuples(*[st.integers(-(2**24), 2**24)] * 3))
def test_moving_everything_by_whole_numbers_changes_nothing_but_p(
    seed: int, step: tuple[int, int, int], planes_of: Callable[[Document], Planes]
) -> None:
    # Coordinates in 2^-20 below 2^5, moved by whole numbers below 2^24: 44 bits at most, so nothing rounds.
    here = rounded(drawn(seed))
    there = copy.deepcopy(here)
    for quadric in there["quadrics"]:
        for row, by in zip(quadric["transform"], step, strict=False):
            row[3] += by
        for clip in quadric.get("clip", []):
            clip[3] -= sum(weight * by for weight, by in zip(clip[:3], step, strict=True))
    for row, by in zip(there["camera"]["world_from_camera"], step, strict=False):
        row[3] += by
    first, second = planes_of(here), planes_of(there)
    for plane in ("P.X", "P.Y", "P.Z"):
        del first[plane], second[plane]
    assert_same_bytes(first, second)


def rounded(body: Document) -> Document:
    """The scene with places in multiples of 2^-20 and weights of clips in multiples of 2^-8, by transforms."""
    body = scaled(body, 0)
    for quadric in body["quadrics"]:
        for row in quadric["transform"]:
            row[3] = round(row[3] * 2**20) / 2**20
        if "clip" in quadric:
            quadric["clip"] = [[round(x * 2**8) / 2**8 for x in clip] for clip in quadric["clip"]]
            quadric["clip"] = [clip if any(clip[:3]) else [1, 0, 0, clip[3]] for clip in quadric["clip"]]
    for row in body["camera"]["world_from_camera"]:
        row[3] = round(row[3] * 2**20) / 2**20
    return body


@settings(max_examples=15)
@given(seed=SEEDS, order=st.randoms(use_true_random=False))
def test_order_matters_only_in_ties(seed: int, order: Any, planes_of: Callable[[Document], Planes]) -> None:
    body = drawn(seed)
    for k, quadric in enumerate(body["quadrics"]):
        # A copy keeps its original's id: whoever wins a tie, the plane is the same.
        same = [other for other in body["quadrics"][:k] if {**other, "id": 0} == {**quadric, "id": 0}]
        quadric["id"] = same[0]["id"] if same else k + 1
    shuffled = [*body["quadrics"]]
    order.shuffle(shuffled)
    assert_same_bytes(planes_of(body), planes_of({**body, "quadrics": shuffled}))


@pytest.mark.parametrize("name", MIXED)
def test_the_first_of_two_copies_wins(name: str, planes_of: Callable[[Document], Planes]) -> None:
    body = SCENES[name]
    copies = [{**quadric, "id": 1} for quadric in body["quadrics"]]
    alone, doubled = planes_of(body), planes_of({**body, "quadrics": [*body["quadrics"], *copies]})
    assert_same_bytes(alone, doubled)


@settings(max_examples=12)
@given(seed=SEEDS, cut=st.tuples(st.integers(1, 31), st.integers(1, 23)))
def test_crops_make_the_whole(seed: int, cut: tuple[int, int], planes_of: Callable[[Document], Planes]) -> None:
    body = drawn(seed)
    whole = planes_of(body)
    x, y = cut
    for x0, x1 in ((0, x), (x, 32)):
        for y0, y1 in ((0, y), (y, 24)):
            part = planes_of({**body, "camera": {**body["camera"], "crop": [x0, y0, x1, y1]}})
            assert_same_bytes(part, {name: plane[y0:y1, x0:x1] for name, plane in whole.items()})


HIDDEN: list[Document] = [
    {"shape": "sphere", "center": [0, 0, 40], "radius": 3, "id": 11},
    {"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, 1], "id": 12},
    {"shape": "ellipsoid", "center": [4e4, 0, -100], "radii": [1, 2, 3], "id": 13},
    {"shape": "cylinder", "center": [0, 0, 50], "z_range": [-1, 1], "capped": True, "id": 14},
    {"shape": "sphere", "center": [0, 0, -5], "clip": [[0, 0, 1, -1e6]], "id": 15},
    {"shape": "cone", "center": [0, 0, 1e9], "z_range": [-1, 0], "id": 16},
]


@pytest.mark.parametrize("name", MIXED)
def test_quadrics_that_are_not_seen_change_nothing(name: str, planes_of: Callable[[Document], Planes]) -> None:
    body = SCENES[name]
    crowded = planes_of({**body, "quadrics": [*HIDDEN[:3], *body["quadrics"], *HIDDEN[3:]]})
    assert not np.isin(crowded["id"], range(11, 17)).any()
    assert_same_bytes(planes_of(body), crowded)


@pytest.mark.parametrize("name", MIXED)
def test_channels_do_not_depend_on_each_other(name: str, planes_of: Callable[[Document], Planes]) -> None:
    body = SCENES[name]
    everything = planes_of(body)
    backwards = planes_of({**body, "output": {**body["output"], "channels": CHANNELS[::-1]}})
    assert_same_bytes(everything, {plane: backwards[plane] for plane in everything})
    for channel in CHANNELS:
        # Without ZBack other kernels see closed surfaces, and may round N and P otherwise; the rest is unique.
        alone = [channel] if channel not in {"N", "P"} else [channel, "ZBack"]
        some = planes_of({**body, "output": {**body["output"], "channels": alone}})
        assert_same_bytes(some, {plane: everything[plane] for plane in some})
