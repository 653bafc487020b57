"""One image is rendered once, however many ask for it at once, and found again wherever it is."""

import asyncio
from dataclasses import replace
from pathlib import Path

import httpx
import pytest

from conicoid_service.settings import Settings
from tests.service.conftest import FAKE, SCENE, named, serving, uncached
from tests.service.jobs.asking import ended, submit
from tests.service.test_http import assert_problem

pytestmark = pytest.mark.anyio


def source(response: httpx.Response) -> str:
    """Where an image came from, by the stages that its request needed."""
    return "rendered" if "cast;dur=2.000" in response.headers["server-timing"] else "found"


async def test_those_who_ask_at_once_share_one_rendering(search_path: None, tmp_path: Path) -> None:  # noqa: ARG001
    async with serving(uncached(), FAKE) as client:
        scene = named(f"until {tmp_path / 'go'}")
        asking = [asyncio.create_task(client.post("/v1/render", json=scene)) for _ in range(6)]
        await asyncio.sleep(0.5)
        (tmp_path / "go").touch()
        answers = [await one for one in asking]
        assert {answer.status_code for answer in answers} == {200}
        assert len({answer.content for answer in answers}) == 1
        assert sorted(map(source, answers)) == ["found"] * 5 + ["rendered"]


async def test_who_leaves_takes_the_image_from_nobody(search_path: None, tmp_path: Path) -> None:  # noqa: ARG001
    async with serving(uncached(), FAKE) as client:
        scene = named(f"until {tmp_path / 'go'}")
        first, second = (asyncio.create_task(client.post("/v1/render", json=scene)) for _ in range(2))
        await asyncio.sleep(0.5)
        first.cancel()
        await asyncio.sleep(1)
        (tmp_path / "go").touch()
        assert (await second).status_code == 200


async def test_who_asks_when_the_last_has_left_is_not_left_alone(search_path: None) -> None:  # noqa: ARG001
    async with serving(uncached(), FAKE) as client:
        scene = named("sleep 1")
        first = asyncio.create_task(client.post("/v1/render", json=scene))
        await asyncio.sleep(0.5)
        first.cancel()
        assert (await client.post("/v1/render", json=scene)).status_code == 200


async def test_failure_is_told_to_all_who_wait_for_it(search_path: None) -> None:  # noqa: ARG001
    async with serving(uncached(), FAKE) as client:
        scene = named("abort")
        for answer in await asyncio.gather(*(client.post("/v1/render", json=scene) for _ in range(3))):
            assert_problem(answer, 500, "render-crashed")


async def test_image_of_a_job_is_found_by_renders_even_after_a_restart(search_path: None, tmp_path: Path) -> None:  # noqa: ARG001
    settings = replace(Settings(image_cache_limit=0), data_dir=tmp_path)
    async with serving(settings, FAKE) as client:
        job = await submit(client, SCENE)
        assert (await ended(client, job["href"]))["state"] == "succeeded"
        image = await client.get(f"{job['href']}/frames/0")
    async with serving(settings, FAKE) as client:
        again = await client.post("/v1/render", json=SCENE)
        assert (again.content, again.headers["etag"]) == (image.content, image.headers["etag"])
        assert source(again) == "found"
