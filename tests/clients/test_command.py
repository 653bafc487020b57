"""The command end to end: with and without a server, with files and streams, on the real engine."""

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from conicoid_client import Client
from conicoid_client.exr import decode
from tests.clients.command import CONICOID, ENVIRONMENT, conicoid, paragraph

SCENE: dict[str, Any] = {
    "conicoid": 1,
    "quadrics": [
        {"shape": "sphere", "center": [0, 0, -3]},
        {"shape": "cylinder", "radius": 0.2, "center": [1, 0, -4], "z_range": [-1, 1], "capped": True},
    ],
    "camera": {"width": 64, "height": 48, "fov_y": 60},
}
TEXT = json.dumps(SCENE).encode()
BAD = json.dumps(SCENE | {"quadrics": [{"shape": "sphere", "radius": -1}]}).encode()


@pytest.fixture(scope="module")
def image(address: str) -> bytes:
    with Client(address) as client:
        return client.render(TEXT).exr


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.json"
    path.write_bytes(TEXT)
    return path


def test_command_service_and_client_give_the_same_bytes(address: str, image: bytes, scene: Path) -> None:
    alone = conicoid("render", str(scene), "-o", "-")
    served = conicoid("render", str(scene), "-o", "-", CONICOID_SERVER=address)
    posted = httpx.post(f"{address}/v1/render", content=TEXT, headers={"Content-Type": "application/json"}, timeout=60)
    assert (alone.returncode, alone.stderr) == (served.returncode, served.stderr) == (0, b"")
    assert alone.stdout == served.stdout == posted.content == image


def test_a_command_needs_no_key_for_the_service_in_its_own_process(image: bytes, scene: Path) -> None:
    done = conicoid("render", str(scene), "-o", "-", CONICOID_API_KEYS="a=key")
    assert (done.returncode, done.stderr, done.stdout) == (0, b"", image)


def test_render_writes_the_image_and_its_picture_and_nothing_else(image: bytes, scene: Path) -> None:
    here = scene.parent
    done = conicoid("render", "scene.json", "-o", "out.exr", "--preview", "out.png", cwd=here)
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")
    assert sorted(path.name for path in here.iterdir()) == ["out.exr", "out.png", "scene.json"]
    assert (here / "out.exr").read_bytes() == image
    shown = conicoid("preview", "out.exr", "-o", "-", cwd=here)
    assert (shown.returncode, shown.stdout) == (0, (here / "out.png").read_bytes())


def test_verbose_says_what_was_written_and_how_long_it_took(address: str, image: bytes, scene: Path) -> None:
    done = conicoid("render", "scene.json", "-o", "out.exr", "-v", "--server", address, cwd=scene.parent)
    text = done.stderr.decode()
    assert text.startswith("scene.json: ")
    assert all(f"{stage} " in text for stage in ("parse", "setup", "cast", "encode"))
    assert f"out.exr: {len(image):,} bytes" in text


def test_a_stream_is_as_good_as_a_file(address: str, image: bytes) -> None:
    rendered = conicoid("render", "-", "-o", "-", "--server", address, stdin=TEXT)
    assert rendered.stdout == image
    described = conicoid("info", "-", "--json", stdin=rendered.stdout)
    assert json.loads(described.stdout)["display_window"] == [0, 0, 64, 48]
    assert conicoid("preview", "-", "-o", "-", stdin=image).stdout.startswith(b"\x89PNG")
    assert conicoid("canonical", "-", "--server", address, stdin=TEXT).returncode == 0


def test_precision_on_the_command_line_wins(address: str, scene: Path) -> None:
    done = conicoid("render", str(scene), "-o", "-", "--precision", "float32", "--server", address)
    assert decode(done.stdout).attributes["conicoid/precision"] == "float32"


def test_precision_on_the_command_line_hides_no_mistake_in_the_scene(address: str) -> None:
    twice = TEXT[:-1] + b', "camera": {}}'
    done = conicoid("render", "-", "-o", "-", "--precision", "float32", "--server", address, stdin=twice)
    assert done.returncode == 2
    assert "camera" in paragraph(done)


@pytest.mark.parametrize(
    "body", [BAD, b"", b"{", b"[1e999]", b"\xff"], ids=["value", "empty", "json", "number", "text"]
)
def test_a_bad_scene_is_2_by_the_service_and_writes_nothing(address: str, body: bytes, tmp_path: Path) -> None:
    done = conicoid("render", "-", "-o", "out.exr", "--server", address, stdin=body, cwd=tmp_path)
    assert done.returncode == 2
    assert paragraph(done)
    assert not list(tmp_path.iterdir())


def test_a_bad_scene_is_2_without_a_server_and_names_place_value_rule_and_remedy(tmp_path: Path) -> None:
    done = conicoid("render", "-", "-o", "out.exr", stdin=BAD, cwd=tmp_path)
    assert done.returncode == 2
    assert paragraph(done) == "conicoid: quadrics[0].radius: -1 is not > 0; give a positive radius [scene-value]\n"
    assert not list(tmp_path.iterdir())


def test_canonical_without_a_server_starts_no_render_process(scene: Path, tmp_path: Path) -> None:
    kernels = tmp_path / "kernels"  # where each of them begins by taking a place
    assert conicoid("canonical", str(scene), CONICOID_CACHE_DIR=str(kernels)).returncode == 0
    assert not kernels.exists()


def test_canonical_is_its_own_canonical_form_and_renders_to_the_same_bytes(address: str, image: bytes) -> None:
    once = conicoid("canonical", "-", "--server", address, stdin=TEXT).stdout
    assert conicoid("canonical", "-", "--server", address, stdin=once).stdout == once
    assert conicoid("canonical", "-", stdin=TEXT).stdout == once
    assert conicoid("render", "-", "-o", "-", "--server", address, stdin=once).stdout == image


LISTED = SCENE | {"quadrics": [{"shape": "sphere", "count": 2, "center": [[0, 0, -3], [1, 0, -4]], "radius": 1}]}
NAMED = json.dumps(SCENE | {"quadrics": [{"shape": "sphere", "count": 2, "center": "@c"}]}).encode()


@pytest.fixture
def arrays(tmp_path: Path) -> Path:
    np.savez(tmp_path / "arrays.npz", c=np.array([[0, 0, -3], [1, 0, -4]], np.float32))
    return tmp_path / "arrays.npz"


def test_arrays_in_a_file_render_as_lists_in_the_scene_do(address: str, arrays: Path) -> None:
    with Client(address) as client:
        listed = client.render(LISTED).exr
        assert client.render(NAMED, arrays=arrays.read_bytes()).exr == listed
        assert client.render(NAMED, arrays={"c": np.array([[0.0, 0, -3], [1, 0, -4]])}).exr == listed
    named = arrays.with_name("scene.json")
    named.write_bytes(NAMED)
    for server in ([], ["--server", address]):
        done = conicoid("render", str(named), "--arrays", str(arrays), "-o", "-", *server)
        assert (done.returncode, done.stderr) == (0, b"")
        assert done.stdout == listed
    piped = conicoid("render", str(named), "--arrays", "-", "-o", "-", "--server", address, stdin=arrays.read_bytes())
    assert piped.stdout == listed


def test_kept_quadrics_render_as_their_own_document_does_from_every_camera(address: str, image: bytes) -> None:
    with Client(address) as client:
        kept = {"conicoid": 1, "scene": client.keep(TEXT)}
        for fov_y in (60, 30, 60):
            camera = {"camera": SCENE["camera"] | {"fov_y": fov_y}}
            assert client.render(kept | camera).exr == client.render(SCENE | camera).exr
        assert client.render(kept | {"camera": SCENE["camera"]}).exr == image


def test_the_canonical_form_needs_no_arrays_any_more(address: str, arrays: Path) -> None:
    done = conicoid("canonical", "-", "--arrays", str(arrays), "--server", address, stdin=NAMED)
    assert done.returncode == 0
    assert [quadric["id"] for quadric in json.loads(done.stdout)["quadrics"]] == [1, 2]
    verified = conicoid("verify", "-", "--arrays", str(arrays), "--samples", "5", "--server", address, stdin=NAMED)
    assert verified.returncode == 0, verified.stderr


def test_mistakes_with_arrays_are_2_and_say_which(address: str, arrays: Path, tmp_path: Path) -> None:
    alone = conicoid("canonical", "-", "--server", address, stdin=NAMED)
    assert alone.returncode == 2
    assert "quadrics[0].center" in paragraph(alone)
    broken = tmp_path / "broken.npz"
    broken.write_bytes(b"x")
    refused = conicoid("canonical", "-", "--arrays", str(broken), "--server", address, stdin=NAMED)
    assert refused.returncode == 2
    assert "arrays: not an .npz file" in paragraph(refused)
    both = conicoid("canonical", "-", "--arrays", "-", stdin=arrays.read_bytes())
    assert both.returncode == 2
    assert "both standard input" in paragraph(both)
    missing = conicoid("canonical", "-", "--arrays", str(tmp_path / "nothing.npz"), stdin=NAMED)
    assert missing.returncode == 1
    assert "nothing.npz" in paragraph(missing)


def test_info_describes_windows_channels_and_camera(image: bytes) -> None:
    facts = json.loads(conicoid("info", "-", "--json", stdin=image).stdout)
    assert facts["bytes"] == len(image)
    assert facts["compression"] == "zip"
    assert facts["channels"].keys() == {"Z", "N.X", "N.Y", "N.Z"}
    # The sphere's nearest point is 2 away; pixel centres lie beside the axis, so depths start just above.
    assert 2 < facts["channels"]["Z"]["min"] < 2.01
    assert facts["channels"]["Z"]["coverage"] == facts["channels"]["N.X"]["coverage"] > 0.1
    assert facts["conicoid"]["camera"]["projection"] == "pinhole"
    text = conicoid("info", "-", stdin=image).stdout.decode()
    assert all(word in text for word in ("64 x 48", "zip", "sceneHash", "world_from_camera", "worldToNDC"))


def test_device_lists_what_is_here_and_what_a_service_uses(address: str) -> None:
    here = conicoid("device")
    assert here.returncode == 0
    assert b"compute units" in here.stdout
    assert json.loads(conicoid("device", "--json").stdout)[0]["platform"] in here.stdout.decode()
    with Client(address) as client:
        used = client.device()
    assert json.loads(conicoid("device", "--json", "--server", address).stdout) == used


@pytest.mark.parametrize(("ending", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_render_ends_quietly_and_leaves_nothing(
    ending: signal.Signals, status: int, tmp_path: Path
) -> None:
    large = SCENE | {"camera": {"width": 8000, "height": 8000, "fov_y": 60}}
    (tmp_path / "scene.json").write_text(json.dumps(large))
    command = subprocess.Popen(
        [CONICOID, "render", "scene.json", "-o", "out.exr"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    while not children(command.pid):
        time.sleep(0.05)
    workers = children(command.pid)
    command.send_signal(ending)
    assert command.communicate(timeout=60) == (b"", b"")
    assert command.returncode == status
    # Ended by the command, or by the kernel on the command's own end, which takes effect a moment later.
    deadline = time.monotonic() + 30
    while any(map(alive, workers)):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.json"]


def children(pid: int) -> list[int]:
    """Processes that a process has started, from all of its threads."""
    return [int(child) for task in Path(f"/proc/{pid}/task").glob("*/children") for child in task.read_text().split()]


def alive(pid: int) -> bool:
    """Whether a process still runs; one that has ended but was not yet reaped does not."""
    try:
        status = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return status.rpartition(")")[2].split()[0] != "Z"


def test_a_terminal_sees_progress_and_a_file_never_does(address: str, image: bytes, scene: Path) -> None:
    terminal, stderr = pty.openpty()
    with os.fdopen(terminal, "rb", buffering=0) as screen:
        done = subprocess.run(
            [CONICOID, "render", scene.name, "-o", "-", "--server", address],
            cwd=scene.parent,
            stdout=subprocess.PIPE,
            stderr=stderr,
            check=True,
            env={**ENVIRONMENT, "TERM": "xterm"},
        )
        os.close(stderr)
        assert b"rendering scene.json" in screen.read(4096)
    assert done.stdout == image


def test_help_and_version_load_nothing_heavy() -> None:
    """They answer in the time that the interpreter takes to start."""
    heavy = {"httpx", "numpy", "rich", "PIL", "cmap", "OpenEXR", "fastapi", "conicoid", "conicoid_service"}
    for flag in ("--help", "--version"):
        program = (
            "import sys; before = set(sys.modules); from conicoid_client.command import main; "
            f"status = main([{flag!r}]); print(status, *sorted(set(sys.modules) - before), file=sys.stderr)"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        status, *loaded = done.stderr.split()
        assert status == "0"
        assert "conicoid" in done.stdout
        assert not heavy & set(loaded)


@pytest.mark.parametrize(("ending", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_server_that_still_starts_ends_when_it_is_told(ending: signal.Signals, status: int) -> None:
    with subprocess.Popen([CONICOID, "serve", "--port", "0"], stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        assert server.stderr.readline().startswith("serving")
        while not children(server.pid):  # they start while the application is loaded
            time.sleep(0.01)
        server.send_signal(ending)
        try:
            assert server.wait(30) == status
            assert "Traceback" not in server.stderr.read()
        finally:
            server.kill()
