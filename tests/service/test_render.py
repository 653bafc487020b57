"""The whole way on the real device: document to image, the same bytes every time."""

import io
import json
import os
import signal
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import OpenEXR
import pytest
from numpy.typing import NDArray

from conicoid_service.pipeline import Commands
from conicoid_service.settings import Settings
from tests.checkout import ROOT
from tests.service.conftest import SCENE, children, serving
from tests.service.test_http import JSON

pytestmark = pytest.mark.anyio


def one_view(path: Path) -> bytes:
    """An example, of a batch its first view."""
    document = json.loads(path.read_bytes())
    if "cameras" in document:
        document["camera"] = document.pop("cameras")[0]
    return json.dumps(document).encode()


EXAMPLES = {path.stem: one_view(path) for path in sorted((ROOT / "examples").glob("*.json"))}


def environment(**changes: str) -> Settings:
    """The environment's settings, but every request is rendered, even one for an image that was rendered already."""
    return Settings.from_environment({**os.environ, "CONICOID_IMAGE_CACHE_LIMIT": "0", **changes})


def compiled(cache: Path) -> set[Path]:
    return set(cache.rglob("*.so"))


@pytest.fixture(scope="module")
async def real(anyio_backend: str) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    """An application with the real render process, on the device that the environment asks for."""
    async with serving(environment(), Commands()) as client:
        yield client


def read(data: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    file = OpenEXR.File(io.BytesIO(data), separate_channels=True)
    return file.header(), {name: channel.pixels for name, channel in file.channels().items()}


async def test_a_sphere_is_where_it_should_be(real: httpx.AsyncClient) -> None:
    camera = {"width": 41, "height": 31, "fov_y": 60}
    channels = ["Z", "T", "ZBack", "N", "P", "id", "A"]
    scene = SCENE | {"camera": camera, "output": {"channels": channels}}
    response = await real.post("/v1/render", json=scene)
    assert response.status_code == 200
    _, planes = read(response.content)
    middle = (15, 20)  # the pixel that looks straight ahead at a unit sphere 3 away
    seen = {name: plane[middle].item() for name, plane in planes.items()}
    expected = {
        "Z": 2, "T": 2, "ZBack": 4, "N.X": 0, "N.Y": 0, "N.Z": 1, "P.X": 0, "P.Y": 0, "P.Z": -2, "id": 1, "A": 1
    }  # fmt: skip
    assert seen == pytest.approx(expected, abs=2.0**-22)  # one float32 ulp of the largest
    corner = {name: plane[0, 0].item() for name, plane in planes.items()}
    assert corner == {name: np.inf if name in ("Z", "T", "ZBack") else 0 for name in planes}


async def test_world_points_in_the_image_project_to_their_own_pixels(real: httpx.AsyncClient) -> None:
    camera = {
        "width": 64,
        "height": 48,
        "fx": 60,
        "fy": 50,
        "cx": 20,
        "cy": 30,
        "look_at": {"eye": [3, 2, 1], "target": [0, 0, -3], "up": [0, 1, 0]},
    }
    for lens in (camera, camera | {"projection": "orthographic", "fx": 20, "fy": 16}):
        scene = SCENE | {"camera": lens, "output": {"channels": ["P", "A"]}}
        header, planes = read((await real.post("/v1/render", json=scene)).content)
        rows, columns = np.nonzero(planes["A"])
        assert len(rows) > 100
        points = np.stack([planes[f"P.{axis}"][rows, columns] for axis in "XYZ"] + [np.ones(len(rows))], axis=1)
        x, y, _, w = (points @ header["worldToNDC"].astype(np.float64)).T
        # Coordinates are at most 8 and rounded to float32, and so are the matrix's entries: far below 1e-3 pixels.
        assert x / w * 64 == pytest.approx(columns + 0.5, abs=1e-3)
        assert y / w * 48 == pytest.approx(rows + 0.5, abs=1e-3)


@pytest.mark.parametrize("name", EXAMPLES)
async def test_an_example_gives_the_same_bytes_again_and_from_its_canonical_form(
    real: httpx.AsyncClient, name: str
) -> None:
    body = EXAMPLES[name]
    first = await real.post("/v1/render", content=body, headers=JSON)
    assert first.status_code == 200, first.text
    again = await real.post("/v1/render", content=body, headers=JSON)
    canonical = (await real.post("/v1/canonical", content=body, headers=JSON)).content
    resolved = await real.post("/v1/render", content=canonical, headers=JSON)
    assert first.content == again.content == resolved.content
    assert first.headers["etag"] == again.headers["etag"] == resolved.headers["etag"]


async def test_no_request_waits_for_a_compiler(tmp_path: Path) -> None:
    """Warming compiles every kernel: rendering all examples adds none to a cache that was empty."""
    async with serving(environment(CONICOID_CACHE_DIR=str(tmp_path))) as client:
        (await client.get("/v1/device")).raise_for_status()
        warmed = compiled(tmp_path)
        assert warmed
        for body in EXAMPLES.values():
            (await client.post("/v1/render", content=body, headers=JSON)).raise_for_status()
        assert compiled(tmp_path) == warmed


async def test_a_killed_render_process_costs_no_request_and_no_pixel(real: httpx.AsyncClient) -> None:
    before = (await real.post("/v1/render", json=SCENE)).content
    for child in children():
        os.kill(child, signal.SIGKILL)
    after = await real.post("/v1/render", json=SCENE)
    assert after.status_code == 200
    assert after.content == before


async def test_device_is_the_one_that_renders(real: httpx.AsyncClient) -> None:
    device = (await real.get("/v1/device")).json()
    assert device["compute_units"] >= 1
    assert device["threads"] >= 1
    words = os.environ.get("CONICOID_DEVICE", "").lower().split()
    assert all(word in " ".join(map(str, device.values())).lower() for word in words)


async def test_a_device_that_is_not_there_is_a_problem_that_names_those_that_are() -> None:
    async with serving(Settings(device="no such device")) as client:
        response = await client.post("/v1/render", json=SCENE)
        assert response.status_code == 503
        assert response.json()["code"] == "device-missing"
        assert "no such device" in response.json()["detail"]
