"""How much work casting does for fixed scenes, counted: a clock tells too little on a busy machine.

Each limit is some per cent above what was counted when it was written. Lower them when casting learns to skip more.
"""

from dataclasses import replace
from pathlib import Path

import pytest

from conicoid.engine import Renderer
from conicoid.extent import model_of
from conicoid.scene import Scene
from conicoid.view import view_of
from conicoid_bench.pieces import half_spheres, ruled, sticks
from conicoid_bench.workloads import ellipsoids
from tests.cl.kernel_sources import Edit, edit_kernels

# Z shows what was counted in its tile.
COUNTER = [
    ("tile.h", "    reals key[CELLS];", "    int counted; reals key[CELLS];"),
    ("cast.cl", "    tile_state tile;", "    tile_state tile; tile.counted = 0;"),
    (
        "channels.h",
        "    out[cell] = TO_FLOATS(hit ? depth : background);",
        "    out[cell] = (floats)((float)tile->counted);",
    ),
]
# Entries of its list that were looked at.
VISITS = ("cast.cl", "        if (r->general < 0) {", "        tile.counted++; if (r->general < 0) {")
# Pixels where hits of general records were sought, a vector at a time.
SOUGHT = ("general.h", "            hits h = candidates(", "            tile->counted += LANES; hits h = candidates(")
SCENES = {
    "few and large": ellipsoids(64, 0.6),
    "many": ellipsoids(20_000, 3.0),
    "deep": ellipsoids(2_000, 40.0),
}
GENERAL = {"sticks": sticks(20_000, 3.0), "ruled": ruled(1_000, 4.0), "half spheres": half_spheres(64, 0.6)}


def renderer_that_counts(what: Edit, folder: Path) -> Renderer:
    with pytest.MonkeyPatch.context() as patch:
        edit_kernels(folder, [*COUNTER, what], patch)
        return Renderer()


@pytest.fixture(scope="module")
def counting(tmp_path_factory: pytest.TempPathFactory) -> Renderer:
    return renderer_that_counts(VISITS, tmp_path_factory.mktemp("edited"))


@pytest.fixture(scope="module")
def counting_sought(tmp_path_factory: pytest.TempPathFactory) -> Renderer:
    return renderer_that_counts(SOUGHT, tmp_path_factory.mktemp("edited"))


def counted(renderer: Renderer, scene: Scene) -> int:
    """What the renderer's edited kernels count in all tiles."""
    output = replace(scene.output, channels=("Z",), precision="float64", background_depth=0.0)
    depth = renderer.render(replace(scene, output=output)).planes["Z"]
    return int(depth[::16, ::16].sum(dtype=int))


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
    assert counted(counting, SCENES[name]) <= limit


@pytest.mark.parametrize(("name", "limit"), [("sticks", 4_700_000), ("ruled", 3_450_000), ("half spheres", 1_110_000)])
def test_hits_of_general_records_are_sought_at_no_more_pixels(name: str, limit: int, counting_sought: Renderer) -> None:
    assert counted(counting_sought, GENERAL[name]) <= limit


@pytest.mark.parametrize(("name", "limit"), [("few and large", 64), ("many", 0), ("deep", 2_000)])
def test_no_more_quadrics_need_double_double(name: str, limit: int, counting: Renderer) -> None:
    assert accurate(counting, SCENES[name]) <= limit


@pytest.mark.parametrize(("name", "limit"), [("few and large", 12), ("many", 1_000), ("deep", 100)])
def test_no_more_pixels_are_left_open(name: str, limit: int, counting: Renderer) -> None:
    frame = counting.render(SCENES[name])
    assert frame.settled == 0
    assert frame.refined <= limit
