"""What the planes are called, typed and filled with, and how the window follows the hits."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conicoid.engine import Frame, Renderer
from tests.oracle import Truth
from tests.scenes import CATALOGUE, Document, as_scene

PLANES = {
    "Z": ["Z"], "T": ["T"], "ZBack": ["ZBack"], "N": ["N.X", "N.Y", "N.Z"], "P": ["P.X", "P.Y", "P.Z"],
    "id": ["id"], "A": ["A"],
}  # fmt: skip
SCENES = ["crop", "caps_are_clipped", "orthographic_look_at", "back_of_a_cap", "camera_normals_facing", "crowd"]
TIGHT = ["tight_window", "tight_window_in_a_crop", "tight_window_around_nothing"]
BACKGROUNDS = {"background_zero": 0.0, "background_beyond_float32": np.inf, "world_normals_outward": np.inf}


def with_output(name: str, **output: object) -> Document:
    document = CATALOGUE[name].document
    return {**document, "output": {**document["output"], **output}}


def copied(frame: Frame) -> dict[str, NDArray[Any]]:
    """A frame's planes last until the next render."""
    return {name: plane.copy() for name, plane in frame.planes.items()}


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("name", SCENES)
def test_a_channel_is_the_same_with_and_without_the_others(name: str, precision: str, renderer: Renderer) -> None:
    everything = copied(renderer.render(as_scene(with_output(name, precision=precision))))
    for channel, names in PLANES.items():
        # Without ZBack simpler kernels may run, which round differently: so it is asked each time.
        channels = ["ZBack"] if channel == "ZBack" else [channel, "ZBack"]
        alone = renderer.render(as_scene(with_output(name, precision=precision, channels=channels))).planes
        assert set(alone) == {*names, "ZBack"}
        for plane in names:
            np.testing.assert_array_equal(alone[plane], everything[plane])


@pytest.mark.parametrize("channel", PLANES)
def test_what_is_not_asked_is_not_there(channel: str, renderer: Renderer) -> None:
    planes = renderer.render(as_scene(with_output("crop", channels=[channel]))).planes
    assert set(planes) == set(PLANES[channel])


@pytest.mark.parametrize("name", SCENES)
def test_planes_are_rows_of_float32_and_uint32(name: str, renderer: Renderer) -> None:
    scene = as_scene(CATALOGUE[name].document)
    frame = renderer.render(scene)
    x0, y0, x1, y1 = frame.window
    assert frame.window == scene.camera.crop
    for plane, values in frame.planes.items():
        assert values.shape == (y1 - y0, x1 - x0)
        assert values.dtype == (np.uint32 if plane == "id" else np.float32)
        assert values.flags.c_contiguous


@pytest.mark.parametrize("name", TIGHT)
def test_a_tight_window_is_the_bounding_box_of_the_hits(
    name: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    scene = as_scene(CATALOGUE[name].document)
    x0, y0 = scene.camera.crop[:2]
    hit = exact_image(name).hit
    rows, columns = np.nonzero(hit)
    box = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1) if hit.any() else (0, 0, 1, 1)
    frame = renderer.render(scene)
    assert frame.window == (x0 + box[0], y0 + box[1], x0 + box[2], y0 + box[3])
    np.testing.assert_array_equal(frame.planes["A"], hit[box[1] : box[3], box[0] : box[2]])
    assert frame.planes["Z"].flags.c_contiguous


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("name", BACKGROUNDS)
def test_what_is_not_hit_is_background_and_zero(
    name: str, precision: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    planes = renderer.render(as_scene(with_output(name, precision=precision))).planes
    miss = ~exact_image(name).hit
    assert miss.any()
    for plane, values in planes.items():
        expected = BACKGROUNDS[name] if plane in ("Z", "T", "ZBack") else 0
        assert np.all(values[miss] == expected), plane
        assert not np.any(np.signbit(values[miss].astype(np.float64))), plane
    assert set(np.unique(planes["A"])) == {0, 1}
    assert np.all((planes["id"] != 0) == (planes["A"] == 1))


def test_half_normals_are_computed_as_floats(renderer: Renderer) -> None:
    # The file holds them as half; what is rounded is the float normal, so the engine's planes do not differ.
    halves = copied(renderer.render(as_scene(CATALOGUE["half_normals"].document)))
    floats = renderer.render(as_scene(with_output("half_normals", half_normals=False))).planes
    for plane in PLANES["N"]:
        np.testing.assert_array_equal(halves[plane], floats[plane])
        assert np.all(np.abs(halves[plane].astype(np.float16)) <= 1)


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_the_same_scene_gives_the_same_bits(precision: str, renderer: Renderer) -> None:
    scene = as_scene(with_output("crowd", precision=precision))
    first = copied(renderer.render(scene))
    renderer.render(as_scene(CATALOGUE["crop"].document))
    second = renderer.render(scene).planes
    for plane, values in first.items():
        assert values.tobytes() == second[plane].tobytes()
