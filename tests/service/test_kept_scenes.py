"""Quadrics that are kept are as good as those in a document, for as long as there is room."""

import json
import sys
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest

from conicoid.errors import LimitError
from conicoid_service import document_process
from conicoid_service.blob import Blob
from conicoid_service.errors import UnknownSceneError
from conicoid_service.kept_scenes import KeptScene, KeptScenes
from tests.checkout import ROOT
from tests.malformed import CASES
from tests.service.conftest import FAKE, SCENE, serving, uncached
from tests.service.test_http import JSON, SCENE_ROUTES, assert_problem
from tests.service.test_multipart import LISTS, SET, saved, upload

pytestmark = pytest.mark.anyio

VIEW: dict[str, Any] = {key: value for key, value in SCENE.items() if key != "quadrics"}
QUADRICS: dict[str, Any] = {key: value for key, value in SCENE.items() if key != "camera"}


def spheres(count: int, radius: float = 1) -> dict[str, Any]:
    return QUADRICS | {"quadrics": [{"shape": "sphere", "count": count, "radius": radius, "center": [0, 0, -3]}]}


async def kept(client: httpx.AsyncClient, document: dict[str, Any]) -> str:
    response = await client.post("/v1/scenes", json=document)
    assert response.status_code == 201, response.text
    return str(response.json()["id"])


@pytest.fixture
async def small(search_path: None) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    """A service with room for some 100 quadrics."""
    async with serving(uncached(kept_limit=18_000), FAKE) as client:
        yield client


@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_kept_quadrics_are_those_of_the_document(client: httpx.AsyncClient, path: str) -> None:
    scene_id = await kept(client, QUADRICS)
    for width in (10, 20, 10):
        camera = {"camera": SCENE["camera"] | {"width": width}}
        named = await client.post(path, json=VIEW | camera | {"scene": scene_id})
        own = await client.post(path, json=SCENE | camera)
        assert named.status_code == 200, named.text
        assert named.content == own.content
        assert named.headers.get("etag") == own.headers.get("etag")


async def test_a_client_that_has_the_image_of_a_kept_scene_is_told_so(client: httpx.AsyncClient) -> None:
    named = VIEW | {"scene": await kept(client, QUADRICS)}
    tag = (await client.post("/v1/render", json=named)).headers["etag"]
    assert (await client.post("/v1/render", json=named, headers={"If-None-Match": tag})).status_code == 304


async def test_a_kept_scene_says_what_it_is(client: httpx.AsyncClient) -> None:
    response = await client.post("/v1/scenes", json=spheres(7))
    about = response.json()
    assert response.headers["location"] == f"/v1/scenes/{about['id']}"
    assert "parse;dur=" in response.headers["server-timing"]
    assert about["quadrics"] == 7
    assert 7 * 150 < about["bytes"] < 7 * 150 + 2000
    assert (await client.get(response.headers["location"])).json() == about


async def test_arrays_are_kept_as_lists_are(client: httpx.AsyncClient) -> None:
    uploaded = await client.post("/v1/scenes", files=upload(SET, arrays=saved(r=np.array([1.0, 2.0]))))
    assert uploaded.json()["id"] == await kept(client, LISTS)


async def test_the_id_is_made_of_the_quadrics_and_of_nothing_else(client: httpx.AsyncClient) -> None:
    scene_id = await kept(client, QUADRICS)
    named = QUADRICS | {"quadrics": [SCENE["quadrics"][0] | {"name": "ball"}]}
    assert scene_id == await kept(client, SCENE) == await kept(client, named)
    assert scene_id != await kept(client, spheres(1, 2))


async def test_names_are_those_of_the_last_time(client: httpx.AsyncClient) -> None:
    for name in ("one", "two"):
        scene_id = await kept(client, QUADRICS | {"quadrics": [SCENE["quadrics"][0] | {"name": name}]})
        canonical = (await client.post("/v1/canonical", json=VIEW | {"scene": scene_id})).json()
        assert canonical["quadrics"][0]["name"] == name


async def test_a_dropped_scene_is_unknown(client: httpx.AsyncClient) -> None:
    place = f"/v1/scenes/{await kept(client, spheres(3))}"
    dropped = await client.delete(place)
    assert (dropped.status_code, dropped.content) == (204, b"")
    assert_problem(await client.get(place), 404, "unknown-scene")
    assert_problem(await client.delete(place), 404, "unknown-scene")


@pytest.mark.parametrize("path", SCENE_ROUTES)
@pytest.mark.parametrize("scene_id", ["", "a1", "0" * 64, "../device", "x" * 10_000, "\x00\U0001f600"])
async def test_an_id_that_never_was_one_is_unknown(client: httpx.AsyncClient, path: str, scene_id: str) -> None:
    problem = assert_problem(await client.post(path, json=VIEW | {"scene": scene_id}), 404, "unknown-scene")
    assert "POST /v1/scenes" in problem["detail"]
    assert len(problem["detail"]) < 500


@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_a_mistake_beside_an_unknown_id_is_named_first(client: httpx.AsyncClient, path: str) -> None:
    assert_problem(await client.post(path, json={"conicoid": 1, "scene": "a1"}), 422, "scene-missing")


@pytest.mark.parametrize("case", [case for case in CASES if case.pointer.startswith("quadrics")], ids=lambda c: c.name)
async def test_malformed_quadrics_are_not_kept(client: httpx.AsyncClient, case: Any) -> None:
    if case.arrays is None:
        response = await client.post("/v1/scenes", content=case.body, headers=JSON)
    else:
        response = await client.post("/v1/scenes", files={"scene": case.body, "arrays": case.npz()})
    problem = assert_problem(response, 422, case.code)
    assert [error["pointer"] for error in problem["errors"]] == [case.pointer]


@pytest.mark.parametrize(
    ("document", "pointer", "code"),
    [
        ({"conicoid": 1}, "quadrics", "scene-missing"),
        ({"quadrics": []}, "conicoid", "scene-missing"),
        ({"conicoid": 1, "scene": "a1"}, "scene", "scene-unknown-key"),
        (SCENE | {"camera": {"width": 0, "height": 1, "fov_y": 40}}, "camera.width", "scene-value"),
    ],
)
async def test_what_is_kept_is_checked_as_a_document_is(
    client: httpx.AsyncClient, document: dict[str, Any], pointer: str, code: str
) -> None:
    problem = assert_problem(await client.post("/v1/scenes", json=document), 422, code)
    assert (pointer, code) in [(error["pointer"], error["code"]) for error in problem["errors"]]


async def test_limits_hold_for_what_is_kept(client: httpx.AsyncClient) -> None:
    problem = assert_problem(await client.post("/v1/scenes", json=spheres(101)), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (100, 101)


async def test_what_was_not_used_for_longest_makes_room(small: httpx.AsyncClient) -> None:
    first, second = await kept(small, spheres(45)), await kept(small, spheres(45, 2))
    assert (await small.post("/v1/render", json=VIEW | {"scene": first})).status_code == 200
    third = await kept(small, spheres(45, 3))
    assert_problem(await small.post("/v1/render", json=VIEW | {"scene": second}), 404, "unknown-scene")
    for scene_id in (first, third):
        assert (await small.post("/v1/render", json=VIEW | {"scene": scene_id})).status_code == 200


async def test_a_scene_that_never_fits_is_refused_and_drops_nothing(small: httpx.AsyncClient) -> None:
    first = await kept(small, spheres(50))
    problem = assert_problem(await small.post("/v1/scenes", json=spheres(200)), 413, "limit")
    assert problem["limit"] == 18_000 < problem["asked"]
    assert (await small.get(f"/v1/scenes/{first}")).status_code == 200


async def test_kept_scenes_outlive_the_processes_that_use_them(search_path: None, nothing_left: None) -> None:  # noqa: ARG001
    faulty = replace(FAKE, document=(sys.executable, str(ROOT / "tests/service/crashing_document_process.py")))
    async with serving(uncached(), faulty) as client:
        named = QUADRICS | {"quadrics": [SCENE["quadrics"][0] | {"name": "abort"}]}
        scene_id = await kept(client, QUADRICS)
        assert_problem(await client.post("/v1/render", json=VIEW | {"scene": await kept(client, named)}), 500,
                       "render-crashed")  # fmt: skip
        assert_problem(await client.post("/v1/canonical", content=b"crash", headers=JSON), 500, "render-crashed")
        await kept(client, QUADRICS)
        for path in SCENE_ROUTES:
            assert (await client.post(path, json=VIEW | {"scene": scene_id})).status_code == 200


def test_a_long_id_does_not_reach_the_process_that_speaks_http() -> None:
    limits = {"quadrics": 1, "pixels": 10_000, "bytes of arrays": 1, "frames": 1, "pixels of a job": 10_000}
    for do in ("read", "canonical"):
        with Blob.of(json.dumps(VIEW | {"scene": "x" * 1_000_000}).encode()) as body:
            reply, blobs = document_process.handle(
                {"do": do, "limits": limits, "boundary": None, "frame": None, "band": None}, [body]
            )
        assert len(json.dumps(reply)) < 1000
        for blob in blobs:
            blob.close()


def stored(scene_id: str, size: int) -> KeptScene:
    return KeptScene(scene_id, 1, Blob.of(bytes(size)))


async def test_the_store_closes_what_it_gives_up(nothing_left: None) -> None:  # noqa: ARG001
    store = KeptScenes(10)
    for scene_id, size in (("a", 4), ("b", 4), ("a", 5), ("c", 4), ("d", 10)):
        await store.keep(stored(scene_id, size))
    with pytest.raises(LimitError):
        await store.keep(stored("e", 11))
    with (await store.get("d")).blob as blob:
        assert len(blob) == 10
    for scene_id in "abce":
        with pytest.raises(UnknownSceneError):
            await store.get(scene_id)
    store.close()


def test_many_readers_of_one_file_do_not_disturb_each_other(nothing_left: None) -> None:  # noqa: ARG001
    content = json.dumps(list(range(200_000))).encode()
    with Blob.of(content) as blob, blob.shared() as other:
        halves = zip(blob.chunks(1000), other.chunks(1000), strict=True)
        first, second = (b"".join(pieces) for pieces in zip(*halves, strict=True))
        assert first == second == blob.read() == content
