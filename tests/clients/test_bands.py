"""One frame of many, one band of a frame, bands joined: what the command does with them and says of mistakes."""

import json
from pathlib import Path

import pytest

from tests.clients.command import conicoid, paragraph

CAMERAS = [{"width": 40, "height": 30, "fov_y": fov} for fov in (40, 60)]
QUADRICS = [{"shape": "sphere", "center": [0, 0.3, -4]}]
SCENE = {
    "conicoid": 1,
    "quadrics": QUADRICS,
    "output": {"data_window": "tight", "half_normals": True, "compression": "piz"},
}


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a batch, its second frame as a scene of its own, and that frame's bands."""
    folder = tmp_path_factory.mktemp("here")
    (folder / "batch.json").write_text(json.dumps({**SCENE, "cameras": CAMERAS}))
    (folder / "one.json").write_text(json.dumps({**SCENE, "camera": CAMERAS[1]}))
    for band in range(3):
        part = ("--frame", "1", "--band", f"{band}/3", "-o", f"{band}.exr")
        assert conicoid("render", "batch.json", *part, cwd=folder).returncode == 0
    (folder / "broken.exr").write_bytes((folder / "1.exr").read_bytes()[:-9])
    return folder


def test_a_frame_of_many_is_the_image_of_its_camera_with_a_server_and_without(here: Path, address: str) -> None:
    alone = conicoid("render", "one.json", "-o", "-", cwd=here).stdout
    for server in ((), ("--server", address)):
        assert conicoid("render", "batch.json", "--frame", "1", "-o", "-", *server, cwd=here).stdout == alone
        assert conicoid("render", "one.json", "--frame", "0", "-o", "-", *server, cwd=here).stdout == alone
        band = conicoid("render", "one.json", "--band", "1/3", "-o", "-", *server, cwd=here).stdout
        assert band == (here / "1.exr").read_bytes()


def test_bands_join_to_the_bytes_of_one_piece(here: Path) -> None:
    whole = conicoid("render", "batch.json", "--frame", "1", "-o", "-", cwd=here).stdout
    done = conicoid("join", "batch.json", "0.exr", "1.exr", "2.exr", "--frame", "1", "-o", "whole.exr", cwd=here)
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")
    assert (here / "whole.exr").read_bytes() == whole
    assert conicoid("join", "one.json", "0.exr", "1.exr", "2.exr", "-o", "-", cwd=here).stdout == whole


def test_arrays_and_precision_are_the_same_for_both(here: Path) -> None:
    import numpy as np

    sets = [{"shape": "sphere", "count": 2, "center": "@c"}]
    (here / "sets.json").write_text(json.dumps({**SCENE, "quadrics": sets, "camera": CAMERAS[0]}))
    np.savez(here / "sets.npz", c=np.array([[0.0, 0, -3], [1, 0, -4]]))
    options = ("--arrays", "sets.npz", "--precision", "float64")
    whole = conicoid("render", "sets.json", "-o", "-", *options, cwd=here).stdout
    for band in ("0/2", "1/2"):
        conicoid("render", "sets.json", "--band", band, "-o", f"set-{band[0]}.exr", *options, cwd=here)
    joined = conicoid("join", "sets.json", "set-0.exr", "set-1.exr", "-o", "-", *options, cwd=here)
    assert joined.stdout == whole, joined.stderr


@pytest.mark.parametrize(
    ("command", "status", "said"),
    [
        (
            "render batch.json -o x.exr",
            2,
            "cameras: makes a batch, and this takes one view; give a camera, or name one of",
        ),
        (
            "render batch.json --frame 2 -o x.exr",
            2,
            "frame: 2 is not a frame of this scene; give one of 0 to 1 [parameter]",
        ),
        ("render one.json --frame 1 -o x.exr", 2, "frame: 1 is not a frame of this scene; give one of 0 to 0"),
        ("render one.json --band 30/31 -o x.exr", 2, "band: 30/31 is not one of at most 30 bands"),
        ("render one.json --progress openjd -o -", 2, "--progress prints on standard output; give -o"),
        ("join batch.json 0.exr 1.exr 2.exr -o x.exr", 2, "cameras: makes a batch"),
        ("join batch.json 0.exr --frame 7 -o x.exr", 2, "frame: 7 is not a frame of this scene"),
        ("join one.json 0.exr 2.exr -o x.exr", 1, "band 2 of 2 begins at row 20 and not at 10; give all bands"),
        ("join one.json 0.exr broken.exr 2.exr -o x.exr", 1, "band 2 of 3 is damaged"),
        ("join batch.json 0.exr 1.exr 2.exr --frame 0 -o x.exr", 1, "band 1 of 3 is of another frame, scene or output"),
        ("join one.json 0.exr 1.exr nothing.exr -o x.exr", 1, "nothing.exr: no such file"),
        ("join one.json one.json -o x.exr", 1, "band 1 of 1 is damaged, or no band at all"),
    ],
)
def test_a_mistake_is_one_paragraph_and_leaves_no_file(command: str, status: int, said: str, here: Path) -> None:
    done = conicoid(*command.split(), cwd=here)
    assert (done.returncode, done.stdout) == (status, b"")
    assert said in paragraph(done)
    assert not (here / "x.exr").exists()


@pytest.mark.parametrize("band", ["3/3", "1", "-1/3", "a/b", "1/0", "0/1/2"])
def test_a_band_is_one_of_some(band: str, here: Path) -> None:
    done = conicoid("render", "one.json", f"--band={band}", "-o", "x.exr", cwd=here)
    assert done.returncode == 2
    assert f"'{band}' is not I/N with I from 0 to N - 1" in done.stderr.decode()


def test_a_scheduler_is_told_what_is_done_and_why_it_is_not(here: Path) -> None:
    done = conicoid("render", "one.json", "-o", "told.exr", "--progress", "openjd", cwd=here)
    assert done.stdout.decode().splitlines() == [
        "openjd_status: rendering told.exr", "openjd_progress: 0", "openjd_progress: 100"
    ]  # fmt: skip
    done = conicoid("join", "one.json", "1.exr", "-o", "told.exr", "--progress", "openjd", cwd=here)
    *_, last = done.stdout.decode().splitlines()
    assert last.startswith("openjd_fail: band 1 of 1 begins at row 10 and not at 0; give all bands")
    assert paragraph(done).startswith("conicoid: band 1 of 1 begins at row 10")
