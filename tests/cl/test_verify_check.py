"""A frame that is right passes; every kind of damage is found, named and counted."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conicoid.engine import Renderer
from conicoid.scene import Scene
from conicoid.verify import Verdict, check, every_place
from tests.scenes import CATALOGUE, as_scene
from tests.scenes.catalogue import document, pinhole

Planes = dict[str, NDArray[Any]]

SCENE = as_scene(
    document([{"shape": "sphere", "center": [0.1, 0, -4], "id": 5}, {"shape": "plane", "center": [0, 0, -6], "id": 9}],
             pinhole(crop=[2, 1, 14, 16], far=6))
)  # fmt: skip
HIT, SEEN_PLANE = (7, 8), (0, 0)


@pytest.fixture(scope="module")
def rendered(renderer: Renderer) -> Planes:
    return {name: plane.copy() for name, plane in renderer.render(SCENE).planes.items()}


@pytest.fixture
def planes(rendered: Planes) -> Planes:
    return {name: plane.copy() for name, plane in rendered.items()}


def judged(planes: Planes, scene: Scene = SCENE) -> Verdict:
    shape = next(iter(planes.values())).shape
    return check(scene, planes, scene.camera.crop, every_place(shape))


def test_a_right_frame_passes(planes: Planes) -> None:
    verdict = judged(planes)
    assert (verdict.wrong, verdict.wrong_hits, verdict.wrong_ids, verdict.differences) == (0, 0, 0, [])
    assert verdict.misrounded == {"Z": 0, "T": 0, "ZBack": 0}
    assert verdict.pixels == verdict.hits == planes["Z"].size


@pytest.mark.parametrize("name", list(CATALOGUE)[::12])
def test_the_catalogue_passes_without_its_own_oracle(name: str, renderer: Renderer) -> None:
    text = CATALOGUE[name].document
    scene = as_scene({**text, "output": {**text["output"], "precision": "exact", "data_window": "full"}})
    assert not judged(renderer.render(scene).planes, scene).differences


def next_float(value: Any) -> Any:
    return np.nextafter(np.float32(value), np.float32(np.inf))


DAMAGES: dict[str, tuple[str, Callable[[Any], Any], str]] = {
    "a hit masked out": ("A", lambda _: 0, "wrong_hits"),
    "a hit without an id": ("id", lambda _: 0, "wrong_hits"),
    "the id of what is behind": ("id", lambda _: 9, "wrong_ids"),
    "depth one ulp off": ("Z", next_float, "Z"),
    "distance one ulp off": ("T", next_float, "T"),
    "back one ulp off": ("ZBack", next_float, "ZBack"),
    "depth undefined": ("Z", lambda _: np.nan, "Z"),
    "depth infinite": ("Z", lambda _: np.inf, "Z"),
    "normal off": ("N.X", lambda x: x + 2.0**-22, "normal"),
    "normal undefined": ("N.Y", lambda _: np.nan, "normal"),
    "position off": ("P.Z", lambda z: next_float(next_float(z)), "position"),
    "position infinite": ("P.X", lambda _: np.inf, "position"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_one_damaged_value_is_found(planes: Planes, name: str) -> None:
    plane, damage, found = DAMAGES[name]
    planes[plane][HIT] = damage(planes[plane][HIT])
    verdict = judged(planes)
    assert verdict.wrong == 1
    assert {(d.x, d.y) for d in verdict.differences} == {(HIT[1] + 2, HIT[0] + 1)}
    assert plane in {d.channel for d in verdict.differences}
    counts = {
        "wrong_hits": verdict.wrong_hits,
        "wrong_ids": verdict.wrong_ids,
        **verdict.misrounded,
        "normal": (verdict.normal_error or 0) > 2.0**-23,
        "position": (verdict.position_error or 0) > 1,
    }
    assert [name for name, count in counts.items() if count] == [found]


def test_the_last_bits_that_are_promised_to_nobody_pass(planes: Planes) -> None:
    # One ulp beside the rounded value is at most 1.5 ulp, 0.75 * 2^-23 below 1, from the exact one.
    planes["N.Z"][HIT] = np.nextafter(planes["N.Z"][HIT], np.float32(0))
    verdict = judged(planes)
    assert verdict.wrong == 0
    assert verdict.normal_error is not None
    assert 2.0**-25 < verdict.normal_error < 2.0**-23


@pytest.mark.parametrize(
    ("plane", "value"), [("A", 1), ("id", 5), ("Z", 5.5), ("T", np.nan), ("N.X", 0.25), ("P.Y", 1)]
)
def test_a_miss_holds_the_background_and_zeros(renderer: Renderer, plane: str, value: float) -> None:
    scene = as_scene(document([{"shape": "sphere", "center": [0, 0, -4], "id": 5}], pinhole()))
    planes = {name: plane.copy() for name, plane in renderer.render(scene).planes.items()}
    assert judged(planes, scene).wrong == 0
    planes[plane][0, 0] = value
    assert judged(planes, scene).wrong == 1


def test_only_the_planes_that_are_there_are_judged(planes: Planes) -> None:
    verdict = judged({"Z": planes["Z"]})
    assert (verdict.misrounded, verdict.normal_error, verdict.position_error) == ({"Z": 0}, None, None)


def test_each_pixel_reports_its_progress(planes: Planes) -> None:
    calls: list[None] = []
    check(SCENE, planes, SCENE.camera.crop, every_place((2, 3)), after_each=lambda: calls.append(None))
    assert len(calls) == 6
