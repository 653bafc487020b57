"""Jobs beyond one service's life, and what damage, time and a full store do to them."""

import asyncio
import json
import time
from pathlib import Path

import httpx
import pytest

from conicoid_service.blob import Blob
from conicoid_service.jobs import keeper
from conicoid_service.jobs.files import Files
from conicoid_service.pipeline import Commands
from tests.checkout import ROOT
from tests.service.conftest import FAKE, named
from tests.service.jobs.asking import batch, ended, events_of, in_state, serving, settings, stored, submit
from tests.service.test_http import assert_problem

pytestmark = pytest.mark.anyio

EVERY = 2**60  # older than that is every file


def write(files: Files, name: str, data: bytes) -> None:
    with Blob.of(data) as blob:
        files.write(name, blob)


def content(files: Files, name: str) -> bytes:
    blob = files.open(name)
    assert blob is not None
    with blob:
        return blob.read()


async def test_job_outlives_the_service_and_is_finished_by_the_next(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    async with serving(settings(tmp_path), FAKE) as client:
        done = await ended(client, (await submit(client, named("")))["href"])
        job = await submit(client, batch(3, f"until {tmp_path / 'go'}"))
        image = (await client.get(done["frames"][0]["href"])).content
    (tmp_path / "go").touch()
    async with serving(settings(tmp_path), FAKE) as client:
        assert (await ended(client, job["href"]))["state"] == "succeeded"
        assert (await client.get(done["frames"][0]["href"])).content == image
        assert len((await client.get("/v1/jobs")).json()["jobs"]) == 2


async def test_damaged_image_is_rendered_again(client: httpx.AsyncClient, tmp_path: Path) -> None:
    job = await ended(client, (await submit(client, batch(3)))["href"])
    hrefs = [frame["href"] for frame in job["frames"]]
    images = [(await client.get(href)).content for href in hrefs]
    files, names = stored(settings(tmp_path), "images"), [frame["etag"].strip('"') for frame in job["frames"]]
    files.remove(names[0])
    write(files, names[1], images[1][:100])
    write(files, names[2], images[2][:-1] + bytes([images[2][-1] ^ 1]))
    assert [(await client.get(href)).content for href in hrefs] == images
    assert [content(files, name) for name in names] == images


async def test_damaged_quadrics_fail_the_frame_with_the_remedy(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    async with serving(settings(tmp_path), FAKE) as client:
        document = batch(1, f"until {tmp_path / 'go'}")
        job = await submit(client, document)
    files = stored(settings(tmp_path), "quadrics")
    name = next(files.names(EVERY))
    write(files, name, content(files, name)[:100])
    (tmp_path / "go").touch()
    async with serving(settings(tmp_path), FAKE) as client:
        failed = await ended(client, job["href"])
        assert failed["frames"][0]["error"]["code"] == "quadrics-file"
        (tmp_path / "go").touch()
        again = await submit(client, document)
        assert (await ended(client, again["href"]))["state"] == "succeeded"


async def test_frame_that_is_rendered_in_bands_is_what_a_render_in_one_piece_gives(tmp_path: Path) -> None:
    document = json.loads((ROOT / "examples/shapes.json").read_text("utf-8"))
    document["camera"] |= {"width": 160, "height": 90}
    document["output"] = {"channels": ["Z", "N", "id"], "data_window": "tight", "half_normals": True}
    async with serving(settings(tmp_path, band_pixels=160 * 20), Commands()) as client:
        rendered = await client.post("/v1/render", json=document)
        job = await ended(client, (await submit(client, document))["href"])
        assert job["state"] == "succeeded"
        image = await client.get(job["frames"][0]["href"])
        assert (image.content, image.headers["etag"]) == (rendered.content, rendered.headers["etag"])
        assert image.headers["conicoid-settled"] == rendered.headers["conicoid-settled"]
        assert len([*stored(settings(tmp_path), "images").names(EVERY)]) == 1 + 5


async def test_expired_job_is_gone_with_its_files(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    async with serving(settings(tmp_path, result_lifetime_s=1.0, store_limit=0), FAKE) as client:
        job = await submit(client, batch(2))
        await ended(client, job["href"])
        deadline = time.monotonic() + 25
        while (await client.get(job["href"])).status_code == 200:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.2)
        while [*stored(settings(tmp_path), "images").names(EVERY)]:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.2)


async def test_store_that_is_full_of_needed_images_takes_no_more_jobs(
    tmp_path: Path,
    search_path: None,  # noqa: ARG001
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(keeper, "EVICT_S", keeper.RECLAIM_S)
    async with serving(settings(tmp_path, store_limit=100), FAKE) as client:
        await ended(client, (await submit(client, batch(1)))["href"])
        deadline = time.monotonic() + 20
        while (response := await client.post("/v1/jobs", json=batch(1))).status_code == 202:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.2)
        assert_problem(response, 507, "storage")
        assert int(response.headers["retry-after"]) >= 1


async def test_two_services_of_one_store_share_its_jobs(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    one_settings = settings(tmp_path)
    async with serving(one_settings, FAKE) as one, serving(one_settings, FAKE) as other:
        job = await submit(one, batch(12, "sleep 0.2"))
        watched = events_of((await other.get(job["events"])).text)
        assert watched[-1][0] == "end"
        assert [data["frame"] for name, _, data in watched if name == "frame"].count(3) == 1
        assert (await ended(other, job["href"]))["frames_done"] == 12
        assert (await other.get(f"{job['href']}/frames/7")).content == (
            await one.get(f"{job['href']}/frames/7")
        ).content
        slow = await submit(one, batch(2, "sleep 30"))
        await in_state(one, slow["href"], "running")
        assert (await other.delete(slow["href"])).status_code == 202
        assert (await ended(one, (await submit(one, batch(1)))["href"]))["state"] == "succeeded"
