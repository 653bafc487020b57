"""`conicoid bench error` from end to end on tiny images, and what stands in the documentation."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from conicoid.engine import Frame
from conicoid.engine import Renderer as Engine
from conicoid.scene import Scene
from conicoid_bench.error import run
from conicoid_bench.scenes import built_in, from_file
from conicoid_bench.table import markdown
from conicoid_bench.truth import WrongTruth, truth
from tests.checkout import ROOT
from tests.clients.command import conicoid

EASY = next(built_in(0.02))


def test_every_scene_has_a_name_and_quadrics_that_are_seen() -> None:
    scenes = list(built_in(0.02))
    assert len({scene.name for scene in scenes}) == len(scenes) == 13
    assert all(len(scene.scene.quadrics) for scene in scenes)


def test_results_are_json_that_says_what_ran_where_and_how_wrong(tmp_path: Path) -> None:
    path = tmp_path / "mine.json"
    path.write_text('{"conicoid": 1, "quadrics": [{"shape": "sphere", "center": [0, 0, -4], "id": 8}],'
                    '"camera": {"width": 33, "height": 20, "fov_y": 40}, "output": {"channels": ["id"]}}')  # fmt: skip
    said: list[str] = []
    results = json.loads(json.dumps(run([EASY, from_file(path)], 50, said.append)))
    assert [scene["name"] for scene in results["scenes"]] == ["sphere near", "mine"]
    assert said[0] == "sphere near"
    assert results["device"]["float64"] is True
    for scene in results["scenes"]:
        assert scene["verified"]["pixels"] == 50
        exact = scene["renderers"]["conicoid exact"]
        assert exact["runs"] >= 3
        assert (exact["wrong_hits"], exact["wrong_ids"], exact["worst_ulp"], exact["worst_degrees"]) == (0, 0, 0, 0)
    lines = markdown(results).splitlines()
    assert [line for line in lines if line.startswith("###")] == ["### sphere near", "### mine"]
    assert len([line for line in lines if line.startswith("| conicoid exact | 0 | 0 | 0 | 0 | 0 |")]) == 2


class Damaged(Engine):
    """An engine that gets one depth wrong."""

    def render(self, scene: Scene) -> Frame:
        frame = super().render(scene)
        z = frame.planes["Z"].copy()
        z[z.shape[0] // 2, z.shape[1] // 2] *= np.float32(1 + 2.0**-22)
        return replace(frame, planes=frame.planes | {"Z": z})


def test_nothing_is_measured_against_a_wrong_truth() -> None:
    with pytest.raises(WrongTruth, match="sphere near: `exact` is wrong at 1 pixels; pixel"):
        truth(Damaged(), EASY, 10_000)


def test_the_command_names_the_extra_that_is_missing(tmp_path: Path) -> None:
    program = (
        "import sys; sys.modules['mitsuba'] = None; from conicoid_client.command import main; "
        f"sys.exit(main(['bench', 'error', '-o', {str(tmp_path)!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("conicoid: conicoid bench needs ")
    assert done.stderr.endswith("install with: pip install 'conicoid[bench]'\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["--only-given"], 2, "name a SCENE.json"),
        (["bad.json"], 2, "bad.json: camera: "),
        (["absent.json"], 1, "absent.json: no such file"),
        (["--scale", "0"], 2, "0.01 to 4"),
        (["-o", "absent/out"], 1, "absent does not exist"),
    ],
)
def test_what_makes_no_sense_is_refused_first(arguments: list[str], status: int, message: str, tmp_path: Path) -> None:
    (tmp_path / "bad.json").write_text('{"conicoid": 1, "quadrics": []}')
    done = conicoid("bench", "error", "-o", "out", *arguments, cwd=tmp_path)
    assert done.returncode == status
    assert message in done.stderr.decode()
    assert not (tmp_path / "out").exists()


def test_the_documented_table_is_that_of_the_recorded_results() -> None:
    results = json.loads((ROOT / "bench" / "results" / "error.json").read_bytes())
    assert markdown(results) in (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8")
