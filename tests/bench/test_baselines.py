"""The baselines are honest: where nothing is hard, they are right."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conicoid.device import find_device
from conicoid.engine import Renderer as Engine
from conicoid.scene import Scene
from conicoid_bench.engine import Conicoid
from conicoid_bench.measure import compare
from conicoid_bench.mitsuba_shapes import quaternions
from conicoid_bench.opencl import Textbook, tile_lists
from conicoid_bench.picture import Picture, Renderer
from conicoid_bench.vectorised import Vectorised
from conicoid_bench.workloads import ellipsoids
from tests.scenes import as_scene
from tests.scenes.catalogue import document, orthographic, pinhole

WHOLE: list[dict[str, Any]] = [
    {"shape": "sphere", "center": [-1, 0, -4], "id": 7},
    {"shape": "ellipsoid", "radii": [0.5, 1, 0.7], "rotation": [0.1, 0.5, 0.2, 0.8], "center": [1, 0, -5], "id": 3},
    {"shape": "paraboloid", "radius": 0.6, "center": [0, -1.3, -6], "rotation": [-0.7, 0, 0, 0.7], "id": 9},
]
ENDED: list[dict[str, Any]] = [
    {"shape": "cone", "radius": 0.9, "rotation": [0.3, 0.4, 0, 0.8], "center": [1, 0, -4], "z_range": [-0.7, 0.6],
     "capped": True},
    {"shape": "cylinder", "radius": 0.5, "rotation": [0, 0.5, 0.1, 0.8], "center": [-1, 0, -4], "z_range": [-0.8, 0.8]},
]  # fmt: skip


@pytest.fixture(scope="module")
def engine() -> Engine:
    return Engine()


def rendered(renderer: Renderer, scene: Scene) -> Picture:
    assert renderer.why_not(scene) is None
    job = renderer.prepare(scene)
    return job.picture(job.run())


@pytest.mark.parametrize("camera", [pinhole(), orthographic()], ids=["pinhole", "orthographic"])
@pytest.mark.parametrize("kind", ["textbook float32", "textbook float64", "Kahan float64", "NumPy float64"])
def test_easy_scenes_are_right(engine: Engine, kind: Any, camera: dict[str, Any]) -> None:
    renderer: Renderer = Vectorised() if kind == "NumPy float64" else Textbook(find_device(), kind)
    for quadrics in (WHOLE, ENDED):
        scene = as_scene(document(quadrics, camera))
        if renderer.why_not(scene):
            continue
        exact = rendered(Conicoid(engine, "exact"), scene)
        errors = compare(rendered(renderer, scene), exact)
        assert len(np.unique(exact.id)) == len(quadrics) + 1
        assert (errors.wrong_hits, errors.wrong_ids) == (0, 0)
        assert errors.worst_ulp is not None
        assert errors.worst_degrees is not None
        # Some 16 roundings put b^2 - ac off by 16 u b^2 at most; at a grazing ray the error of its root is the root of
        # that, relative to the depth, and eight times as much of these radii, which turns the normal.
        grazing = 4 * np.sqrt(2.0**-24 if kind == "textbook float32" else 2.0**-53)
        assert errors.worst_ulp <= np.ceil(grazing * 2.0**24)
        # Rounding the components to binary32 turns it by up to sqrt(3) 2^-25 more, and the exact one too.
        assert errors.worst_degrees <= np.degrees(8 * grazing + np.sqrt(3) * 2.0**-24)


def test_kahans_form_decides_where_the_squares_round(engine: Engine) -> None:
    """The ray (257, 0, -1) passes unit spheres with b^2 - ac = 1: a, b and c are whole and exact, b^2 takes 66 bits."""
    kernels = [Textbook(find_device(), "textbook float64"), Textbook(find_device(), "Kahan float64")]
    found = [0, 0]
    for near in range(2**16 + 1, 2**16 + 33, 2):
        sphere = {"shape": "sphere", "center": [257 * near + 257, 0, -near]}
        camera = pinhole(width=258, height=1, fx=1, fy=1, cx=0.5, cy=0.5, crop=[0, 0, 258, 1])
        scene = as_scene(document([sphere], camera))
        assert rendered(Conicoid(engine, "exact"), scene).id[0, 257] == 1
        for k, kernel in enumerate(kernels):
            found[k] += int(rendered(kernel, scene).id[0, 257])
    assert found[1] == 16
    assert found[0] < 16


def test_what_a_baseline_cannot_express_it_says() -> None:
    clipped = as_scene(document([{"shape": "sphere", "center": [0, 0, -4], "clip": [[1, 0, 0, 0]]}], pinhole()))
    general = as_scene(document([{"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 4, 15]}], pinhole()))
    kernel = Textbook(find_device(), "textbook float32")
    assert kernel.why_not(clipped) == Vectorised().why_not(clipped) == "has clips"
    assert kernel.why_not(general) == "has general forms"
    assert Vectorised().why_not(as_scene(document(ENDED, pinhole()))) == "has ranges"
    assert Vectorised().why_not(ellipsoids(20_000, 1.0)) == "has too many quadrics"


def test_tiles_list_every_box_that_touches_them_in_order() -> None:
    rng = np.random.default_rng(3)
    width, height = 70, 45
    low = rng.integers(0, [width, height], (200, 2))
    box = np.concatenate([low, np.minimum(low + rng.integers(0, 40, (200, 2)), [width, height])], axis=1)
    end, entries = tile_lists(box, width, height)
    for tile in range(15):
        y, x = 16 * (tile // 5), 16 * (tile % 5)
        some = (box[:, 2:] > box[:, :2]).all(axis=1)
        touching = some & (box[:, 0] < x + 16) & (box[:, 2] > x) & (box[:, 1] < y + 16) & (box[:, 3] > y)
        listed = entries[end[tile - 1] if tile else 0 : end[tile]]
        assert listed.tolist() == np.flatnonzero(touching).tolist()


def test_a_quaternion_turns_as_its_matrix_does() -> None:
    rotations = ellipsoids(500, 1.0).quadrics.world_from_object[:, :, :3]
    half_turns = np.array([np.diag(signs) for signs in ([1, -1, -1], [-1, 1, -1], [-1, -1, 1], [1, 1, 1])], dtype=float)
    everything = np.concatenate([rotations, half_turns])
    # Entries are sums of a few products of numbers below 1.
    assert np.abs(matrices(quaternions(everything)) - everything).max() < 16 * 2.0**-53


def matrices(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """v -> v + 2 w (q x v) + 2 q x (q x v)."""
    vector, w = quaternion[:, :3], quaternion[:, 3]
    columns = []
    for axis in np.eye(3):
        once = np.cross(vector, axis)
        columns.append(axis + 2 * w[:, None] * once + 2 * np.cross(vector, once))
    return np.stack(columns, axis=2)
