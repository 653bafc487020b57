"""The program of bench/embree, which `make test-embree` builds, against the exact image."""

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from conicoid.engine import Renderer as Engine
from conicoid.scene import Scene
from conicoid_bench.embree import EmbreeProcess
from conicoid_bench.engine import Conicoid
from conicoid_bench.measure import compare
from conicoid_bench.workloads import camera, ellipsoids, spheres
from tests.checkout import ROOT

PROGRAM = ROOT / "build" / "embree_ellipsoids"


def at(scene: Scene, width: int, height: int) -> Scene:
    return replace(scene, camera=camera(width, height))


@pytest.mark.parametrize("configuration", ["", "isa=avx2"], ids=["widest packets", "8 wide"])
@pytest.mark.parametrize(
    "scene", [at(spheres(64, 0.6), 640, 360), at(ellipsoids(50, 1.0), 171, 97)], ids=["spheres", "odd"]
)
def test_it_shows_what_is_there(scene: Scene, configuration: str) -> None:
    job = Conicoid(Engine(), "exact").prepare(scene)
    exact = job.picture(job.run())
    with EmbreeProcess(PROGRAM, scene, configuration) as process:
        build, cast = process.lap()
        picture = process.picture()
    assert min(build, cast) > 0
    # Silhouettes are decided in binary32: some pixel in a thousand of them may fall to the other side.
    errors = compare(picture, exact)
    assert errors.wrong_hits + errors.wrong_ids <= 2
    # Near the ellipsoid its 1 - |o|^2 is off by some 100 x 2^-24 x distance / radius, at most 50 here, and a grazing
    # depth by the root of that, in radii: relative to the distance, sqrt(5000 x 2^-24) / 7.
    assert errors.worst_ulp is not None
    assert errors.worst_ulp <= 2.0**24 * np.sqrt(5000 * 2.0**-24) / 7


def test_a_scene_that_is_no_scene_is_refused(tmp_path: Path) -> None:
    scene = tmp_path / "scene"
    scene.write_bytes(b"\1\0\0\0" * 8)
    assert subprocess.run([PROGRAM, scene], check=False).returncode == 2
