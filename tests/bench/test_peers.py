"""The peers of `conicoid bench speed`: the scenes are what they say, numba's steps are right, the protocol is kept."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from conicoid.engine import Renderer as Engine
from conicoid.scene import Scene
from conicoid_bench.compiled import Numba, serial, set_up
from conicoid_bench.embree import EmbreeProcess, PeerFailed, scene_file
from conicoid_bench.engine import Conicoid
from conicoid_bench.forms import pixel_boxes
from conicoid_bench.measure import compare
from conicoid_bench.picture import Picture
from conicoid_bench.whole import more_than_whole, moved_camera, records
from conicoid_bench.workloads import camera, ellipsoids, out_of_view, sphere_over, spheres
from tests.scenes import as_scene
from tests.scenes.catalogue import document, pinhole


@pytest.fixture(scope="module")
def engine() -> Engine:
    return Engine()


def exact(engine: Engine, scene: Scene) -> Picture:
    job = Conicoid(engine, "exact").prepare(scene)
    return job.picture(job.run())


def at(scene: Scene, width: int, height: int) -> Scene:
    return replace(scene, camera=camera(width, height))


@pytest.mark.parametrize("share", [0.01, 0.3, 0.6, 0.9])
def test_a_sphere_covers_the_share_that_was_asked_for(engine: Engine, share: float) -> None:
    scene = at(sphere_over(share), 960, 540)
    # Pixel centres differ from an area by less than the silhouette's length, of 2 x (960 + 540) pixels at most.
    assert abs(np.count_nonzero(exact(engine, scene).id) / (960 * 540) - share) < 3000 / (960 * 540)
    assert more_than_whole(scene) is None


def test_nothing_is_seen_out_of_view(engine: Engine) -> None:
    scene = out_of_view(200)
    assert not exact(engine, at(scene, 480, 270)).id.any()
    # And NumPy's boxes know it.
    assert not (pixel_boxes(scene)[:, 2:] > pixel_boxes(scene)[:, :2]).all(axis=1).any()


def test_spheres_have_the_volumes_of_the_ellipsoids() -> None:
    round_ones, others = spheres(50, 1.0).quadrics, ellipsoids(50, 1.0).quadrics
    assert round_ones.radii.prod(axis=1) == pytest.approx(others.radii.prod(axis=1), rel=1e-12)
    assert (round_ones.shape == 0).all()


def test_what_the_peers_cannot_express_they_say() -> None:
    ended = as_scene(document([{"shape": "sphere", "center": [0, 0, -4], "z_range": [0, 1]}], pinhole()))
    stretched = as_scene(document([{"shape": "sphere", "transform": np.diag([1, 2, 1, 1]).tolist()}], pinhole()))
    cone = as_scene(document([{"shape": "cone", "radius": 1}], pinhole()))
    found = [more_than_whole(scene) for scene in (ended, stretched, cone, ellipsoids(3, 1.0))]
    assert found == ["has ranges or clips", "has sheared or scaled quadrics", "has other shapes", None]
    cropped = replace(camera(8, 8), crop=(0, 0, 8, 4))
    turned = replace(camera(8, 8), world_from_camera=np.diag([-1.0, 1, -1, 1]))
    for other in (cropped, turned, replace(camera(8, 8), projection="orthographic")):
        assert moved_camera(replace(ellipsoids(3, 1.0), camera=other)) == "has another camera"
    assert moved_camera(ellipsoids(3, 1.0)) is None


def test_boxes_hold_what_is_seen_and_a_pixel_more_at_most(engine: Engine) -> None:
    """Alone in the image each, so that nothing is hidden."""
    scene = at(ellipsoids(12, 1.0), 96, 54)
    lens = np.array([scene.camera.fx, scene.camera.fy, scene.camera.cx, scene.camera.cy])
    rows, near, box = np.empty((12, 12), np.float32), np.empty(12, np.float32), np.empty((12, 4), np.int32)
    serial(set_up)(12, records(scene), lens, 96, 54, rows, near, box)
    quadrics = scene.quadrics
    for k in range(12):
        one = replace(quadrics, **{name: getattr(quadrics, name)[k : k + 1] for name in
                                   ("shape", "radii", "matrix_row", "world_from_object", "id", "z_range", "capped")},
                      clip_start=quadrics.clip_start[:2])  # fmt: skip
        picture = exact(engine, replace(scene, quadrics=one))
        y, x = np.nonzero(picture.id)
        seen = np.array([x.min(), y.min(), x.max() + 1, y.max() + 1])
        assert (np.abs(box[k] - seen) <= 1).all()
        assert (box[k, :2] <= seen[:2]).all()
        assert (box[k, 2:] >= seen[2:]).all()
        assert near[k] <= picture.depth.min()


SEEN = {"few": ellipsoids(30, 2.0), "deep": ellipsoids(200, 60.0), "sphere": sphere_over(0.6)}


@pytest.mark.parametrize("scene", [at(scene, 51, 37) for scene in SEEN.values()], ids=SEEN)
def test_numbas_steps_show_what_is_there(engine: Engine, scene: Scene) -> None:
    job = Numba(serial).prepare(scene)
    errors = compare(job.picture(job.run()), exact(engine, scene))
    assert (errors.wrong_hits, errors.wrong_ids) == (0, 0)
    # Near the ellipsoid its 1 - |o|^2 is off by some 100 x 2^-24 x distance / radius, at most 50 here, and a grazing
    # depth by the root of that, in radii: relative to the distance, sqrt(5000 x 2^-24) / 2.
    assert errors.worst_ulp is not None
    assert errors.worst_ulp <= 2.0**24 * np.sqrt(5000 * 2.0**-24) / 2
    assert errors.worst_degrees is not None
    assert errors.worst_degrees <= np.degrees(np.sqrt(5000 * 2.0**-24) * 2)


FAKE = f"""#!{sys.executable}
import sys
import numpy as np
head = np.fromfile(sys.argv[1], dtype="<i4", count=4)
records = np.fromfile(sys.argv[1], dtype="<f4", offset=32).reshape(head[0], 15)
for line in sys.stdin:
    if line == "lap\\n":
        print("1.5", "2.25", flush=True)
    elif head[0] == 2:
        height, width = head[2], head[1]
        with open(line.removeprefix("picture ").removesuffix("\\n"), "wb") as file:
            file.write(np.full(height * width, -records[1, 2], "<f4").tobytes())
            file.write(np.tile(np.array([0, 0.5, 1], "<f4"), height * width).tobytes())
            file.write(np.arange(height * width, dtype="<u4").tobytes())
        print("done", flush=True)
    else:
        sys.exit(3)
"""


@pytest.fixture
def fake(tmp_path: Path) -> Path:
    program = tmp_path / "fake"
    program.write_text(FAKE)
    program.chmod(0o755)
    return program


def test_times_and_planes_come_through_the_protocol(fake: Path) -> None:
    quadrics = [{"shape": "sphere", "center": [0, 0, -depth], "id": 10 * depth} for depth in (5, 7)]
    scene = as_scene(document(quadrics, pinhole(width=3, height=1, crop=[0, 0, 3, 1])))
    with EmbreeProcess(fake, scene) as process:
        assert process.lap() == (1.5, 2.25)
        picture = process.picture()
        assert process.lap() == (1.5, 2.25)
    assert picture.depth.tolist() == [[7, 7, 7]]
    assert picture.id.tolist() == [[0, 50, 70]]
    assert picture.normal.tolist() == [[[0, 0.5, 1]] * 3]


def test_a_peer_that_ends_is_reported_with_its_status(fake: Path) -> None:
    with EmbreeProcess(fake, at(ellipsoids(5, 1.0), 8, 8)) as process, pytest.raises(PeerFailed, match="status 3"):
        process.picture()


def test_the_scene_file_is_what_the_program_declares() -> None:
    scene = at(ellipsoids(3, 1.0), 40, 30)
    data = np.frombuffer(scene_file(scene), dtype="<i4")
    values = data.view("<f4")
    assert data[:4].tolist() == [3, 40, 30, 0]
    assert values[4:8].tolist() == [np.float32(scene.camera.fx), np.float32(scene.camera.fy), 20, 15]
    last = values[8:].reshape(3, 15)[2]
    assert last[:3].tolist() == scene.quadrics.world_from_object[2, :, 3].astype(np.float32).tolist()
    assert last[3:6].tolist() == scene.quadrics.radii[2].astype(np.float32).tolist()
    assert last[6:].tolist() == scene.quadrics.world_from_object[2, :, :3].ravel().astype(np.float32).tolist()
