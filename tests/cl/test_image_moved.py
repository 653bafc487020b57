"""Moving scene and camera together changes nothing but P, however far."""

import copy
from collections.abc import Callable

import numpy as np
import pytest

from conicoid.engine import Renderer
from tests import oracle
from tests.oracle import Truth
from tests.oracle.band import FLOAT32_BAND
from tests.oracle.judge import Promise, hold_to
from tests.scenes import CATALOGUE, Document, as_scene

# Promises, and the band within which they do not hold, as in test_image_*; the depths and normals of binary32 are
# judged there, unmoved.
PROMISES = {
    "exact": (Promise(depth_steps=0, normal_error=2.0**-23, position_units=1), 0.0),
    "float64": (Promise(depth_steps=1, normal_error=3e-7, position_units=1), 2.0**-47),
    "float32": (Promise(depth_steps=2**31, normal_error=np.inf, position_units=np.inf), FLOAT32_BAND),
}
# Ten million and a little: in binary64 31 bits, which leave 2^-28 as the last place of what is moved there.
OFFSET = (10_000_000.0, -10_000_002.0, 10_000_001.0)
IDENTITY = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def moved(document: Document) -> Document | None:
    """The document moved by OFFSET; None where its numbers would round, or where a pose is derived."""
    if "look_at" in document["camera"]:
        return None
    result = copy.deepcopy(document)
    exact = True

    def add(value: float, step: float) -> float:
        nonlocal exact
        exact = exact and (value + step) - step == value and (value + step) - value == step
        return value + step

    for quadric in result["quadrics"]:
        if "transform" in quadric:
            for row, step in zip(quadric["transform"], OFFSET, strict=False):
                row[3] = add(row[3], step)
        else:
            start = quadric.get("center", [0, 0, 0])
            quadric["center"] = [add(value, step) for value, step in zip(start, OFFSET, strict=True)]
        for clip in quadric.get("clip", []):
            for weight, step in zip(clip[:3], OFFSET, strict=True):
                clip[3] = add(clip[3], -weight * step)
    pose = copy.deepcopy(result["camera"].get("world_from_camera", IDENTITY))
    for row, step in zip(pose, OFFSET, strict=False):
        row[3] = add(row[3], step)
    result["camera"]["world_from_camera"] = pose
    return result if exact else None


MOVED = {name: there for name, scene in CATALOGUE.items() if (there := moved(scene.document)) is not None}


def test_many_scenes_can_be_moved_exactly() -> None:
    assert len(MOVED) >= 60
    assert any("clip" in quadric for there in MOVED.values() for quadric in there["quadrics"])


@pytest.mark.parametrize(
    "name", ["crossed_planes_on_the_axis_pinhole", "eight_clips", "caps_are_clipped", "disc_orthographic"]
)
def test_the_exact_image_does_not_move(name: str, exact_image: Callable[[str], Truth]) -> None:
    here, there = exact_image(name), oracle.image(as_scene(MOVED[name]))
    for field, values in vars(here).items():
        if field == "position":
            offset = np.where(here.hit[..., None], OFFSET, 0)
            # Half a unit of binary64 at 1e7, for each of the two roundings.
            np.testing.assert_allclose(there.position, values + offset, rtol=0, atol=4e-9)
        else:
            np.testing.assert_array_equal(getattr(there, field), values)


@pytest.mark.parametrize("precision", ["exact", "float64", "float32"])
@pytest.mark.parametrize("name", MOVED)
def test_the_engines_image_stays_right(
    name: str, precision: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    document = MOVED[name]
    output = {**document["output"], "precision": precision, "data_window": "full"}
    frame = renderer.render(as_scene({**document, "output": output}))
    here = exact_image(name)
    there = np.where(here.hit[..., None], here.position + OFFSET, 0)
    truth = Truth(**{**vars(here), "position": there})
    promise, band = PROMISES[precision]
    if precision == "float64" and not CATALOGUE[name].only_exact:
        band = 0.0
    hold_to(promise, frame.planes, frame.window, truth, truth.margin >= band)
