"""What docs/any-farm.md shows for other farms renders the frames that one command renders, byte for byte."""

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.checkout import BIN, ROOT
from tests.clients.command import ENVIRONMENT, conicoid
from tests.running import Service

PAGE = (ROOT / "docs/any-farm.md").read_text()
TEMPLATE = ROOT / "docker/conicoid.openjd.yaml"
FRAMES = range(4)
PATH = {"PATH": f"{BIN}:{os.environ['PATH']}"}


def small_turntable() -> dict[str, Any]:
    """The example, with fewer and smaller frames, of which joining has to cut and to round."""
    scene: dict[str, Any] = json.loads((ROOT / "examples/turntable.json").read_bytes())
    cameras = [{**camera, "width": 20, "height": 64} for camera in scene["cameras"][: len(FRAMES)]]
    return {**scene, "cameras": cameras, "output": {"data_window": "tight", "half_normals": True}}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder like the checkout, with a small scene in it."""
    folder = tmp_path_factory.mktemp("shared folder")
    (folder / "examples").mkdir()
    for name in ("batch.json", "examples/turntable.json"):
        (folder / name).write_text(json.dumps(small_turntable()))
    (folder / "docker").symlink_to(ROOT / "docker")
    return folder


@pytest.fixture(scope="module")
def expected(shared: Path) -> dict[int, bytes]:
    """Each frame in one piece, by one command, and as a service's job has it."""
    frames = {}
    for k in FRAMES:
        done = conicoid("render", "batch.json", "--frame", str(k), "-o", "-", cwd=shared)
        assert done.returncode == 0, done.stderr
        frames[k] = done.stdout
    with Service(shared / "store", shared / "log") as service:
        done = conicoid("submit", "batch.json", "-o", "submitted", cwd=shared, CONICOID_SERVER=service.url)
        assert done.returncode == 0, done.stderr
        assert service.stop() == 0
    assert {k: (shared / f"submitted/frame-{k:05}.exr").read_bytes() for k in FRAMES} == frames
    assert len({*frames.values()}) == len(FRAMES)
    return frames


def blocks(language: str, word: str) -> list[str]:
    found = re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    return [block for block in found if word in block]


def run(command: list[str], shared: Path, **environment: str) -> str:
    done = subprocess.run(
        command, cwd=shared, env={**ENVIRONMENT, **PATH, **environment}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ("word", "written"),
    [
        ("-o out/frame-00003.exr", {3: "out/frame-00003.exr"}),
        ("conicoid join", {3: "out/joined.exr"}),
        ("xargs", {k: f"out/{k}.exr" for k in FRAMES}),
        ("openjd run", {k: f"out/openjd/frame-{k:05}.exr" for k in (0, 3)}),
    ],
)
def test_shell_commands_give_the_frames(
    word: str, written: dict[int, str], shared: Path, expected: dict[int, bytes]
) -> None:
    (script,) = blocks("sh", word)
    run(["bash", "-euo", "pipefail", "-c", script], shared)
    assert {k: (shared / name).read_bytes() for k, name in written.items()} == {k: expected[k] for k in written}


def test_make_renders_what_is_missing(shared: Path, expected: dict[int, bytes]) -> None:
    (makefile,) = blocks("make", "conicoid render")
    (shared / "Makefile").write_text(makefile)
    assert run(["make", "--jobs", "2"], shared).count("conicoid render") == len(FRAMES)
    assert {k: (shared / f"frames/{k}.exr").read_bytes() for k in FRAMES} == expected
    (shared / "frames/2.exr").unlink()
    assert run(["make"], shared).count("conicoid render") == 1
    assert (shared / "frames/2.exr").read_bytes() == expected[2]


def test_a_task_of_a_slurm_array_renders_its_frame(shared: Path, expected: dict[int, bytes]) -> None:
    (script,) = blocks("bash", "SBATCH")
    run(["bash", "-c", script], shared, SLURM_ARRAY_TASK_ID="2")
    assert (shared / "frames/frame-00002.exr").read_bytes() == expected[2]


def test_a_pod_of_an_indexed_job_renders_its_frame(shared: Path, expected: dict[int, bytes]) -> None:
    (manifest,) = blocks("yaml", "completionMode: Indexed")
    (container,) = yaml.safe_load(manifest)["spec"]["template"]["spec"]["containers"]
    command = [word.replace("/shared/", "") for word in container["command"] + container["args"]]
    run(command, shared, JOB_COMPLETION_INDEX="1")
    assert (shared / "frame-00001.exr").read_bytes() == expected[1]


def test_the_template_is_one() -> None:
    subprocess.run([BIN / "openjd", "check", TEMPLATE], check=True, capture_output=True)


def openjd(shared: Path, **parameters: str) -> "subprocess.CompletedProcess[str]":
    given = [f"--job-param={name}={value}" for name, value in parameters.items()]
    return subprocess.run(
        [BIN / "openjd", "run", TEMPLATE, *given],
        cwd=shared, env={**ENVIRONMENT, **PATH}, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("bands", [1, 3])
def test_the_template_gives_the_frames_whole_or_in_bands_and_leaves_nothing_else(
    bands: int, shared: Path, expected: dict[int, bytes]
) -> None:
    folder = shared / f"in {bands}"
    done = openjd(shared, Scene="batch.json", OutputDir=str(folder), Frames="1-3:2", Bands=str(bands))
    assert done.returncode == 0, done.stdout
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {
        f"frame-{k:05}.exr": expected[k] for k in (1, 3)
    }
    assert "openjd_progress: 100" in done.stdout


def test_the_template_renders_in_the_precision_that_is_asked(shared: Path) -> None:
    options = ("--frame", "0", "--precision", "float32", "-o", "-")
    alone = conicoid("render", "batch.json", *options, cwd=shared).stdout
    done = openjd(shared, Scene="batch.json", OutputDir="fast", Frames="0", Bands="2", Precision="float32")
    assert done.returncode == 0, done.stdout
    assert (shared / "fast/frame-00000.exr").read_bytes() == alone


def test_a_task_that_fails_tells_the_scheduler_why(shared: Path) -> None:
    done = openjd(shared, Scene="batch.json", OutputDir="none", Frames="9")
    assert done.returncode != 0
    assert "openjd_fail: frame: 9 is not a frame of this scene; give one of 0 to 3" in done.stdout
