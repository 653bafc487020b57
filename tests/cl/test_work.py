"""How much work casting does for fixed scenes, counted: a clock tells too little on a busy machine.

Each limit is some per cent above what was counted when it was written. Lower them when casting learns to skip more.
"""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from conicoid.engine import Renderer
from conicoid.extent import model_of
from conicoid.scene import Scene
from conicoid.view import view_of
from conicoid_bench.workloads import ellipsoids
from tests.cl.kernel_sources import edit_kernels

# Z shows how many entries of its tile's list were looked at.
COUNT_VISITS = [
    ("tile.h", "    reals key[CELLS];", "    int visited; reals key[CELLS];"),
    ("cast.cl", "    tile_state tile;", "    tile_state tile; tile.visited = 0;"),
    ("cast.cl", "        if (r->general < 0) {", "        tile.visited++; if (r->general < 0) {"),
    (
        "channels.h",
        "    out[cell] = TO_FLOATS(hit ? depth : background);",
        "    out[cell] = (floats)((float)tile->visited);",
    ),
]
SCENES = {
    "few and large": ellipsoids(64, 0.6),
    "many": ellipsoids(20_000, 3.0),
    "deep": ellipsoids(2_000, 40.0),
}


@pytest.fixture(scope="module")
def counting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Renderer]:
    with pytest.MonkeyPatch.context() as patch:
        edit_kernels(tmp_path_factory.mktemp("edited"), COUNT_VISITS, patch)
        yield Renderer()


def listed(renderer: Renderer, scene: Scene) -> int:
    """Entries of all tiles' lists."""
    view = view_of(scene.camera, scene.output)
    visible = renderer._setup.run(model_of(scene.quadrics), scene.camera, view, want_back=False)
    return len(renderer._binning.run(visible.box, scene.camera.crop).entries)


def accurate(renderer: Renderer, scene: Scene) -> int:
    view = view_of(scene.camera, scene.output)
    return renderer._setup.run(model_of(scene.quadrics), scene.camera, view, want_back=False).accurate


@pytest.mark.parametrize(("name", "limit"), [("few and large", 9_000), ("many", 112_000), ("deep", 545_000)])
def test_tiles_list_no_more(name: str, limit: int, counting: Renderer) -> None:
    assert listed(counting, SCENES[name]) <= limit


@pytest.mark.parametrize(("name", "limit"), [("few and large", 7_800), ("many", 92_000), ("deep", 48_000)])
def test_tiles_look_at_no_more_before_they_end(name: str, limit: int, counting: Renderer) -> None:
    scene = SCENES[name]
    output = replace(scene.output, channels=("Z",), precision="float64", background_depth=0.0)
    depth = counting.render(replace(scene, output=output)).planes["Z"]
    assert depth[::16, ::16].sum(dtype=int) <= limit


@pytest.mark.parametrize(("name", "limit"), [("few and large", 64), ("many", 0), ("deep", 2_000)])
def test_no_more_quadrics_need_double_double(name: str, limit: int, counting: Renderer) -> None:
    assert accurate(counting, SCENES[name]) <= limit


@pytest.mark.parametrize(("name", "limit"), [("few and large", 12), ("many", 1_000), ("deep", 100)])
def test_no_more_pixels_are_left_open(name: str, limit: int, counting: Renderer) -> None:
    frame = counting.render(SCENES[name])
    assert frame.settled == 0
    assert frame.refined <= limit
