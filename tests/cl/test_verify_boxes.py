"""Bounding boxes on the image leave out no quadric that a pixel can see, and most of those that it cannot."""

import json
from pathlib import Path

import numpy as np
import pytest

from conicoid.exact import ExactPixel, ExactScene
from conicoid.scene import Scene
from conicoid.verify import PixelBoxes
from tests.scenes import CATALOGUE, as_scene

LYSOZYME = Path(__file__).parents[2] / "examples" / "lysozyme.json"


def winner(pixel: ExactPixel | None) -> tuple[int, int] | None:
    return None if pixel is None else (pixel.quadric, pixel.kind)


def some_pixels(scene: Scene, count: int) -> list[tuple[int, int]]:
    x0, y0, x1, y1 = scene.camera.crop
    rng = np.random.default_rng(1)
    return list(zip(rng.integers(x0, x1, count).tolist(), rng.integers(y0, y1, count).tolist(), strict=True))


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_is_seen_is_within_its_box(name: str) -> None:
    scene = as_scene(CATALOGUE[name].document)
    exact, boxes = ExactScene(scene), PixelBoxes(scene)
    for x, y in some_pixels(scene, 24):
        assert winner(exact.pixel(x, y, boxes.at(x, y))) == winner(exact.pixel(x, y, range(len(scene.quadrics))))


def test_a_molecule_asks_a_pixel_for_few_of_its_atoms() -> None:
    scene = as_scene(json.loads(LYSOZYME.read_bytes()))
    boxes = PixelBoxes(scene)
    asked = [len(boxes.at(x, y)) for x, y in some_pixels(scene, 200)]
    # Atoms cover the molecule some ten deep; 1,001 would be all.
    assert 0 < np.mean(asked) < 30


def test_boxes_do_not_depend_on_the_order_of_asking() -> None:
    scene = as_scene(CATALOGUE[next(iter(CATALOGUE))].document)
    pixels = some_pixels(scene, 50)
    forwards, backwards = PixelBoxes(scene), PixelBoxes(scene)
    there = [forwards.at(*pixel) for pixel in pixels]
    back = [backwards.at(*pixel) for pixel in reversed(pixels)]
    assert there == back[::-1]
