"""An image that was rendered lately is sent again: the same bytes, without the processes that made them."""

import asyncio
import json
import os
import sys
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from conicoid_service.blob import Blob
from conicoid_service.errors import UnknownSceneError
from conicoid_service.images import MOST_BODIES, Image, Images
from conicoid_service.kept_scenes import KeptScene, KeptScenes
from conicoid_service.recent import MOST
from conicoid_service.settings import Settings
from tests.service.conftest import FAKE, SCENE, named, renamed, serving, uncached
from tests.service.test_http import assert_problem
from tests.service.test_kept_scenes import QUADRICS, VIEW, kept

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("nothing_left", "search_path")]

STAGES = ["queue", "parse", "setup", "cast", "encode"]


def stages(response: httpx.Response) -> dict[str, float]:
    parts = (part.split(";dur=") for part in response.headers["server-timing"].split(", "))
    return {stage: float(duration_ms) for stage, duration_ms in parts}


def sized(width: int) -> dict[str, Any]:
    return SCENE | {"camera": SCENE["camera"] | {"width": width}, "output": {"compression": "none"}}


@pytest.fixture
async def caching() -> AsyncIterator[httpx.AsyncClient]:
    async with serving(Settings(), FAKE) as client:
        yield client


@pytest.fixture
async def always() -> AsyncIterator[httpx.AsyncClient]:
    async with serving(uncached(), FAKE) as client:
        yield client


async def test_the_same_request_is_answered_with_the_same_bytes_and_headers(
    caching: httpx.AsyncClient, always: httpx.AsyncClient
) -> None:
    first, again, rendered = [await one.post("/v1/render", json=SCENE) for one in (caching, caching, always)]
    assert first.content == again.content == rendered.content
    told = [{**response.headers, "server-timing": "", "x-request-id": ""} for response in (first, again, rendered)]
    assert told[0] == told[1] == told[2]
    assert list(stages(first)) == list(stages(again)) == STAGES
    assert stages(first)["encode"] == 3.0  # the fake's own
    assert stages(again) == dict.fromkeys(STAGES, 0.0)


async def test_another_document_of_the_same_image_is_read_but_not_rendered(caching: httpx.AsyncClient) -> None:
    first = await caching.post("/v1/render", json=SCENE)
    again = await caching.post("/v1/render", json=renamed("abort"))
    assert again.content == first.content
    assert stages(again)["parse"] > 0 == stages(again)["cast"] == stages(again)["encode"]


async def test_other_numbers_or_another_output_are_rendered(caching: httpx.AsyncClient) -> None:
    bodies = (SCENE, sized(40), sized(41), SCENE | {"output": {"channels": ["Z"]}})
    images = [(await caching.post("/v1/render", json=body)).content for body in bodies]
    assert len(set(images)) == len(bodies)
    assert [(await caching.post("/v1/render", json=body)).content for body in bodies] == images


async def test_an_image_is_sent_again_while_a_long_render_runs(caching: httpx.AsyncClient, tmp_path: Path) -> None:
    first = await caching.post("/v1/render", json=SCENE)
    long = sized(50) | {"quadrics": named(f"until {tmp_path / 'go'}")["quadrics"]}
    waiting = asyncio.create_task(caching.post("/v1/render", json=long))
    await asyncio.sleep(0.1)
    again = await caching.post("/v1/render", json=SCENE)
    assert again.content == first.content
    assert not waiting.done()
    (tmp_path / "go").touch()
    assert (await waiting).status_code == 200


async def test_an_image_is_sent_again_when_no_process_can_be_started_any_more(tmp_path: Path) -> None:
    once = tmp_path / "once.py"
    faulty = Path(FAKE.render[1])
    once.write_text(f"import os, runpy, sys; os.unlink(__file__); runpy.run_path({str(faulty)!r}, run_name='__main__')")
    async with serving(Settings(), replace(FAKE, render=(sys.executable, str(once)))) as client:
        first = await client.post("/v1/render", json=SCENE)
        assert first.status_code == 200
        dead = sized(50) | {"quadrics": named("abort")["quadrics"]}
        assert (await client.post("/v1/render", json=dead)).status_code in (500, 503)
        assert (await client.post("/v1/render", json=sized(60))).status_code == 503
        for body in (SCENE, renamed("another document")):
            again = await client.post("/v1/render", json=body)
            assert (again.status_code, again.content) == (200, first.content)
        told = await client.post("/v1/render", json=SCENE, headers={"If-None-Match": first.headers["etag"]})
        assert (told.status_code, told.content) == (304, b"")


async def test_a_body_that_was_refused_is_refused_again(caching: httpx.AsyncClient) -> None:
    bad = SCENE | {"quadrics": [{"shape": "sphere", "radius": -1}]}
    for _ in range(2):
        assert_problem(await caching.post("/v1/render", json=bad), 422, "scene-value")


async def test_the_same_bytes_of_another_kind_are_another_body(caching: httpx.AsyncClient) -> None:
    body = json.dumps(SCENE).encode()
    json_type, parts = "application/json", "multipart/form-data; boundary=x"
    assert (await caching.post("/v1/render", content=body, headers={"Content-Type": json_type})).status_code == 200
    problem = await caching.post("/v1/render", content=body, headers={"Content-Type": parts})
    assert_problem(problem, 400, "multipart")


async def test_a_dropped_scene_is_unknown_though_its_image_is_here(caching: httpx.AsyncClient) -> None:
    scene_id = await kept(caching, QUADRICS)
    document = VIEW | {"scene": scene_id}
    first, again = [await caching.post("/v1/render", json=document) for _ in range(2)]
    assert first.content == again.content
    assert stages(again)["encode"] == 0
    (await caching.delete(f"/v1/scenes/{scene_id}")).raise_for_status()
    assert_problem(await caching.post("/v1/render", json=document), 404, "unknown-scene")
    told = await caching.post("/v1/render", json=document, headers={"If-None-Match": first.headers["etag"]})
    assert_problem(told, 404, "unknown-scene")


async def test_what_was_not_asked_for_longest_makes_room() -> None:
    widths = (40, 41, 42)
    async with serving(uncached(), FAKE) as client:
        sizes = [len((await client.post("/v1/render", json=sized(width))).content) for width in widths]
    async with serving(Settings(image_cache_limit=sum(sizes) - 1), FAKE) as client:
        for width in (40, 41, 40, 42):
            await client.post("/v1/render", json=sized(width))
        cached = [stages(await client.post("/v1/render", json=sized(width)))["encode"] == 0 for width in (40, 42, 41)]
    assert cached == [True, True, False]


def image(size: int) -> Image:
    return Image(Blob.of(os.urandom(size)), "hash", 1, 2)


def keep(images: Images, tag: str, size: int) -> bytes:
    with image(size).blob as blob:
        images.keep(tag, Image(blob, "hash", 1, 2))
        return blob.read()


def tags(images: Images, *asked: str) -> list[str]:
    """Those of the tags whose image is here."""
    found = []
    for tag in asked:
        if held := images.get(tag):
            found.append(tag)
            held.blob.close()
    return found


def test_images_take_no_more_than_the_limit() -> None:
    images = Images(10)
    for tag, size in (("a", 4), ("b", 4), ("a", 6), ("c", 4), ("too large", 11), ("nothing", 0)):
        keep(images, tag, size)
    assert tags(images, "a", "b", "c", "too large", "nothing") == ["a", "c", "nothing"]
    keep(images, "d", 5)  # `a` was asked for before `c` and takes 6
    assert tags(images, "a", "c", "d") == ["c", "d"]
    images.close()
    assert tags(images, "c", "d") == []


def test_an_image_that_was_given_out_is_whole_after_it_was_dropped() -> None:
    images = Images(10)
    content = keep(images, "a", 10)
    held = images.get("a")
    assert held
    keep(images, "b", 10)
    with held.blob as blob:
        assert blob.read() == content
    images.close()


def test_nothing_is_kept_where_the_limit_is_nothing() -> None:
    images = Images(0)
    keep(images, "a", 1)
    assert tags(images, "a") == []


def open_descriptors() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def test_images_however_small_take_a_bounded_number_of_descriptors() -> None:
    images, before = Images(10**9), open_descriptors()
    for number in range(MOST + 10):
        keep(images, str(number), 1)
    assert open_descriptors() == before + MOST
    assert tags(images, "9", "10") == ["10"]
    images.close()
    assert open_descriptors() == before


async def test_kept_scenes_however_small_take_a_bounded_number_of_descriptors() -> None:
    scenes, before = KeptScenes(10**9), open_descriptors()
    for number in range(MOST + 10):
        await scenes.keep(KeptScene(str(number), 1, Blob.of(b"q")))
    assert open_descriptors() == before + MOST
    with pytest.raises(UnknownSceneError):
        await scenes.get("9")
    scenes.close()
    assert open_descriptors() == before


def test_bodies_are_remembered_in_bounded_number() -> None:
    images = Images(0)
    for number in range(MOST_BODIES):
        images.note(str(number), f"tag {number}")
    assert images.tag_of("0") == "tag 0"
    images.note("one more", "tag")
    assert images.tag_of("1") is None
    assert images.tag_of("0") == "tag 0"
