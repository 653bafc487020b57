"""What ties over a whole frame is settled once, not pixel by pixel: equal surfaces, and planes that meet planes.

Work is counted, not timed: a pixel that exact arithmetic decides takes some 0.1 ms, so a thousandth of a frame of two
million is a fraction of a second.
"""

from dataclasses import replace

import numpy as np
import pytest

from conicoid.engine import Frame, Renderer
from conicoid.scene import Scene
from tests.oracle.answers import answers
from tests.oracle.promise import broken
from tests.scenes import as_scene
from tests.scenes.catalogue import Document, document
from tests.scenes.floods import FLOODS, flood

WIDTH, HEIGHT = 1920, 1080
FEW = WIDTH * HEIGHT // 1000

BACKDROP = {"shape": "plane", "center": [0.25, -0.5, -9], "rotation": [0.1, 0.2, 0, 1]}
SLAB = {"shape": "parallel_planes", "center": [0, 0, -5], "rotation": [0.1, 0.2, 0, 1]}
TUBE = {"shape": "cylinder", "radius": 30, "center": [0, 0, -6], "z_range": [-1, 1], "capped": True}

TIES: dict[str, list[Document]] = {
    "two backdrops": [BACKDROP, BACKDROP],
    "a backdrop and its matrix": [BACKDROP, {**BACKDROP, "shape": "quadric", "coefficients": [0] * 8 + [0.5, 0]}],
    "a cap on a backdrop": [TUBE, {"shape": "plane", "center": [0, 0, -5]}],
    "two double planes": [{"shape": "quadric", "coefficients": [0, 0, 0, 0, 0, 0, 0, 1, 4, 16]}] * 2,
    "a slab twice": [SLAB, {**SLAB, "radius": 1}],
    "an inner wall twice": [{"shape": "sphere", "radius": 5}] * 2,
}


def render(renderer: Renderer, quadrics: list[Document]) -> Frame:
    camera = {"width": WIDTH, "height": HEIGHT, "fx": 1440, "fy": 1440}
    numbered = [{**quadric, "id": k + 1} for k, quadric in enumerate(quadrics)]
    return renderer.render(as_scene(document(numbered, camera, channels=["Z", "N", "id"])))


def ellipsoids(count: int) -> list[Document]:
    draw = np.random.default_rng(20260201)
    places = draw.uniform((-4, -2.5, -9), (4, 2.5, -5), (count, 3)).tolist()
    radii, turns = draw.uniform(0.05, 0.25, (count, 3)).tolist(), draw.uniform(-1, 1, (count, 4)).tolist()
    return [
        {"shape": "ellipsoid", "center": place, "radii": radius, "rotation": turn}
        for place, radius, turn in zip(places, radii, turns, strict=True)
    ]


def test_a_thousand_ellipsoids_twice_are_those_once(renderer: Renderer) -> None:
    once = ellipsoids(1000)
    first = {name: plane.copy() for name, plane in render(renderer, once).planes.items()}
    frame = render(renderer, once + once)
    assert frame.settled <= FEW
    assert np.count_nonzero(first["id"]) > WIDTH * HEIGHT // 10
    for name, plane in first.items():
        assert plane.tobytes() == frame.planes[name].tobytes(), name


@pytest.mark.parametrize("name", TIES)
def test_a_frame_of_ties_goes_to_the_first(name: str, renderer: Renderer) -> None:
    frame = render(renderer, TIES[name])
    assert frame.settled <= FEW
    assert np.count_nonzero(frame.planes["id"] == 1) > WIDTH * HEIGHT // 2
    assert not np.any(frame.planes["id"] > 1)


@pytest.mark.parametrize("name", FLOODS)
def test_a_flood_of_ties_is_settled_once(name: str, renderer: Renderer) -> None:
    scene = as_scene(flood(name, (WIDTH, HEIGHT)))
    frame = renderer.render(scene)
    assert frame.settled <= FEW
    for x in (100, WIDTH // 2 - 3, WIDTH - 500):
        for y in (50, HEIGHT // 2 - 2, HEIGHT - 200):
            judge(frame, scene, (x, y, x + 6, y + 4))


def judge(frame: Frame, scene: Scene, window: tuple[int, int, int, int]) -> None:
    """Holds a window of a frame to the exact image."""
    x0, y0, x1, y1 = window
    truth = answers(replace(scene, camera=replace(scene.camera, crop=window)))
    wrong = broken({name: plane[y0:y1, x0:x1] for name, plane in frame.planes.items()}, truth)
    assert not wrong, window
