"""`conicoid verify`: a right image is 0, a wrong one is 1 and says where, a bad scene is 2."""

import argparse
import io
import json
import os
import pty
import subprocess
from pathlib import Path
from typing import Any, Self

import numpy as np
import OpenEXR
import pytest

from conicoid_client import Client
from conicoid_client.command import verify
from conicoid_client.command.report import Failure
from conicoid_client.rendering import Rendering
from tests.clients.command import CONICOID, ENVIRONMENT, conicoid, paragraph

SCENE: dict[str, Any] = {
    "conicoid": 1,
    "quadrics": [
        {"shape": "sphere", "center": [0, 0, -3], "id": 4},
        {
            "shape": "cylinder",
            "radius": 0.2,
            "center": [1, 0, -4],
            "z_range": [-1, 1],
            "capped": True,
            "name": "a\u001b",
        },
    ],
    "camera": {"width": 40, "height": 30, "fov_y": 60},
    "output": {"data_window": "tight", "half_normals": True, "compression": "zstd"},
}


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(SCENE))
    return path


def test_a_right_image_is_0_and_every_pixel_of_the_whole_window_is_checked(address: str, scene: Path) -> None:
    done = conicoid("verify", scene.name, "--every-pixel", "--server", address, cwd=scene.parent)
    assert (done.returncode, done.stderr) == (0, b"")
    lines = done.stdout.decode().splitlines()
    assert lines[0] == "scene.json, precision exact"
    assert lines[1].split()[:5] == ["pixels", "checked", "1,200", "of", "1,200,"]
    assert [line.split()[:3] for line in lines[2:5]] == [["wrong", "hits", "0"], ["wrong", "ids", "0"],
                                                         ["misrounded", "Z", "0"]]  # fmt: skip
    assert any(line.startswith("  settled on the host") for line in lines)


def test_json_has_the_same_facts_and_a_stream_is_as_good_as_a_file(address: str) -> None:
    done = conicoid("verify", "-", "--json", "--samples", "50", "--server", address, stdin=json.dumps(SCENE).encode())
    assert done.returncode == 0
    facts = json.loads(done.stdout)
    assert (facts["scene"], facts["precision"], facts["pixels"], facts["wrong"]) == ("standard input", "exact", 50, 0)
    assert facts["image_pixels"] == 1200
    assert facts["misrounded"] == {"Z": 0}
    assert 0 < facts["normal_error"] <= 2.0**-23
    assert facts["settled"] >= 0


def test_binary32_is_found_out_and_is_1(address: str, scene: Path) -> None:
    done = conicoid("verify", str(scene), "--every-pixel", "--precision", "float32", "--server", address)
    assert done.returncode == 1
    assert b"precision float32" in done.stdout
    text = paragraph(done)
    assert "of 1,200 pixels are not as `precision: exact` promises" in text
    assert "Z is " in text


def test_without_a_server_it_renders_here(scene: Path) -> None:
    assert conicoid("verify", str(scene), "--samples", "20").returncode == 0


def test_a_bad_scene_is_2(address: str) -> None:
    done = conicoid("verify", "-", "--server", address, stdin=b'{"conicoid": 1}')
    assert (done.returncode, done.stdout) == (2, b"")
    assert "quadrics" in paragraph(done)


@pytest.mark.parametrize(
    "arguments", [["--samples", "0"], ["--samples", "9", "--every-pixel"], ["--precision", "best"]]
)
def test_bad_usage_is_2(arguments: list[str]) -> None:
    assert conicoid("verify", "-", *arguments).returncode == 2


class Damaging:
    """A service whose images have one value changed."""

    def __init__(self, client: Client, channel: str, value: float) -> None:
        self._client, self._channel, self._value = client, channel, value

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def canonical(self, scene: bytes, *, arrays: bytes | None) -> bytes:
        return self._client.canonical(scene, arrays=arrays)

    def render(self, scene: bytes) -> Rendering:
        rendering = self._client.render(scene)
        return Rendering(damaged(rendering.exr, self._channel, self._value), None, {}, rendering.settled)


def damaged(exr: bytes, channel: str, value: float) -> bytes:
    image = OpenEXR.File(io.BytesIO(exr), separate_channels=True)
    channels = {name: plane.pixels.copy() for name, plane in image.channels().items()}
    channels[channel][15, 20] = value
    stream = io.BytesIO()
    header = {name: image.header()[name] for name in ("compression", "type", "dataWindow", "displayWindow")}
    OpenEXR.File(header, channels).write(stream)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("channel", "value", "message"),
    [
        ("id", 2, "id is 2, exactly 4"),
        ("A", 0, "A is 0, exactly 1"),
        ("Z", np.nextafter(np.float32(2), np.float32(3)), "Z is 2.00000024, exactly 2.0"),
        ("N.Z", 0.5, "N.Z is 0.5, exactly 0.99"),
    ],
)
def test_a_damaged_image_is_reported_with_the_place(
    address: str, scene: Path, monkeypatch: pytest.MonkeyPatch, channel: str, value: float, message: str
) -> None:
    monkeypatch.setattr(verify, "connect", lambda _: Damaging(Client(address), channel, value))
    options = argparse.Namespace(
        scene=str(scene), arrays=None, every_pixel=True, samples=0, precision=None, server=None, json=False
    )
    with pytest.raises(Failure) as failure:
        verify.run(options)
    assert "1 of 1,200 pixels" in str(failure.value)
    assert f"pixel (20, 15): {message}" in str(failure.value)


def test_a_terminal_sees_the_progress_of_checking(address: str, scene: Path) -> None:
    terminal, stderr = pty.openpty()
    with os.fdopen(terminal, "rb", buffering=0) as screen:
        command = [CONICOID, "verify", scene.name, "--every-pixel", "--server", address]
        subprocess.run(command, cwd=scene.parent, stdout=subprocess.DEVNULL, stderr=stderr, check=True,
                       env={**ENVIRONMENT, "TERM": "xterm"})  # fmt: skip
        os.close(stderr)
        assert b"checking scene.json" in screen.read(65536)
