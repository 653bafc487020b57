"""Kept scenes are the job store's: every server of it has them, and the next one; with `--farm` a farm's servers do."""

import asyncio
import errno
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack
from pathlib import Path

import httpx
import pytest

from conicoid.canonical import quadrics_hash
from conicoid.quadrics_file import quadrics_from
from conicoid_service.blob import Blob
from conicoid_service.errors import StorageError, UnknownSceneError
from conicoid_service.jobs.storage import Storage
from conicoid_service.kept_scenes import Kept, KeptScene, KeptScenes
from tests.service.conftest import FAKE
from tests.service.jobs.asking import serving, settings, stored
from tests.service.jobs.test_job_lives import EVERY, content, write
from tests.service.test_http import SCENE_ROUTES, assert_problem
from tests.service.test_kept_scenes import QUADRICS, VIEW, kept, spheres

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("search_path")]

LIMIT = 18_000  # for some 100 quadrics


@pytest.fixture
async def two(tmp_path: Path, anyio_backend: str) -> AsyncIterator[list[httpx.AsyncClient]]:  # noqa: ARG001
    """Two services of one store, small ones."""
    async with AsyncExitStack() as open_:
        yield [await open_.enter_async_context(serving(settings(tmp_path, kept_limit=LIMIT), FAKE)) for _ in range(2)]


async def asked(client: httpx.AsyncClient, scene_id: str, path: str = "/v1/render") -> httpx.Response:
    return await client.post(path, json=VIEW | {"scene": scene_id})


async def test_kept_scene_outlives_the_service(tmp_path: Path) -> None:
    async with serving(settings(tmp_path), FAKE) as client:
        scene_id = await kept(client, QUADRICS)
        about = (await client.get(f"/v1/scenes/{scene_id}")).json()
        answers = [(await asked(client, scene_id, path)).content for path in SCENE_ROUTES]
    async with serving(settings(tmp_path), FAKE) as client:
        assert (await client.get(f"/v1/scenes/{scene_id}")).json() == about
        assert [(await asked(client, scene_id, path)).content for path in SCENE_ROUTES] == answers


async def test_services_of_one_store_have_the_same_scenes(two: list[httpx.AsyncClient]) -> None:
    one, other = two
    scene_id = await kept(one, spheres(3))
    for client in (other, one):
        assert (await asked(client, scene_id)).status_code == 200
    assert (await other.delete(f"/v1/scenes/{scene_id}")).status_code == 204
    for client in (one, other):
        assert_problem(await asked(client, scene_id), 404, "unknown-scene")
        assert_problem(await client.get(f"/v1/scenes/{scene_id}"), 404, "unknown-scene")
        assert_problem(await client.delete(f"/v1/scenes/{scene_id}"), 404, "unknown-scene")
    assert scene_id == await kept(other, spheres(3))
    assert (await asked(one, scene_id)).status_code == 200


async def test_the_limit_is_that_of_all_services_together(two: list[httpx.AsyncClient]) -> None:
    one, other = two
    scenes = [await kept(client, spheres(45, radius)) for radius, client in enumerate((one, other, one), 1)]
    for client in two:
        assert [(await client.get(f"/v1/scenes/{one}")).status_code for one in scenes] == [404, 200, 200]
    problem = assert_problem(await other.post("/v1/scenes", json=spheres(200)), 413, "limit")
    assert problem["limit"] == LIMIT


@pytest.mark.parametrize("path", SCENE_ROUTES)
@pytest.mark.parametrize("damage", ["cut", "changed", "lost"])
async def test_damaged_scene_is_given_up_and_can_be_kept_again(tmp_path: Path, path: str, damage: str) -> None:
    async with serving(settings(tmp_path), FAKE) as client:
        scene_id = await kept(client, QUADRICS)
        sound = (await asked(client, scene_id, path)).content
    files = stored(settings(tmp_path), "quadrics")
    data = content(files, scene_id)
    match damage:
        case "cut":
            write(files, scene_id, data[:-1])
        case "changed":  # the last byte of the last number
            write(files, scene_id, data[:-1] + bytes([data[-1] ^ 1]))
        case "lost":
            files.remove(scene_id)
    async with serving(settings(tmp_path), FAKE) as client:
        await client.post("/v1/render", json=VIEW | spheres(9))  # so that the render process has others
        camera = {"camera": VIEW["camera"] | {"width": 41}}  # not a stored image
        problem = assert_problem(await client.post(path, json=VIEW | camera | {"scene": scene_id}), 404,
                                 "unknown-scene")  # fmt: skip
        assert "keep it again" in problem["detail"]
        assert_problem(await client.get(f"/v1/scenes/{scene_id}"), 404, "unknown-scene")
        assert scene_id == await kept(client, QUADRICS)
        assert (await asked(client, scene_id, path)).content == sound
    assert quadrics_hash(quadrics_from(content(files, scene_id))) == scene_id


async def test_full_disk_refuses_a_scene_and_keeps_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(name: str, blob: Blob) -> None:  # noqa: ARG001
        raise OSError(errno.ENOSPC, "No space left on device")

    async with serving(settings(tmp_path), FAKE) as client:
        scene_id = await kept(client, spheres(1))
        with monkeypatch.context() as patch:
            patch.setattr(type(stored(settings(tmp_path), "quadrics")), "write", staticmethod(refuse))
            refused = await client.post("/v1/scenes", json=spheres(2))
        assert_problem(refused, 507, "storage")
        assert "retry-after" in refused.headers
        assert (await asked(client, scene_id)).status_code == 200


@pytest.mark.parametrize("scene_id", ["", "0" * 64, "0" * 63 + "\x00", "../device", "%", "é" * 64])
async def test_store_is_not_asked_for_what_is_no_id(client: httpx.AsyncClient, scene_id: str) -> None:
    assert_problem(await asked(client, scene_id), 404, "unknown-scene")


def test_files_of_kept_scenes_are_not_swept(tmp_path: Path) -> None:
    storage = Storage(settings(tmp_path))
    try:
        for name in ("a", "b"):
            with Blob.of(b"quadrics") as blob:
                storage.quadrics.write(name * 64, blob)
        storage.scenes.put(Kept("a" * 64, 1, 8), {}, 0)
        storage.remove_quadrics(EVERY)
        assert [*storage.quadrics.names(EVERY)] == ["a" * 64]
        storage.scenes.drop("a" * 64)
        storage.remove_quadrics(EVERY)
        assert [*storage.quadrics.names(EVERY)] == []
    finally:
        storage.close()


class Shelf:
    """A store with one scene, that may be away."""

    def __init__(self) -> None:
        self.away, self.opened = False, 0

    async def put(self, about: Kept, blob: Blob) -> None:  # noqa: ARG002
        raise StorageError("away")

    async def find(self, scene_id: str) -> Kept | None:
        if self.away:
            raise StorageError("away")
        return Kept(scene_id, 1, 8) if scene_id == "a" else None

    async def open(self, scene_id: str) -> Blob | None:  # noqa: ARG002
        self.opened += 1
        await asyncio.sleep(0.05)
        return Blob.of(b"quadrics")

    async def drop(self, scene_id: str) -> None: ...
    async def discard(self, scene_id: str) -> None: ...


@pytest.fixture
def shelf(nothing_left: None) -> Shelf:  # noqa: ARG001
    return Shelf()


async def test_what_many_ask_for_at_once_is_fetched_once(shelf: Shelf) -> None:
    scenes = KeptScenes(100)
    scenes.shelf = shelf
    for scene in await asyncio.gather(*(scenes.get("a") for _ in range(5))):
        assert scene.stored
        scene.blob.close()
    assert shelf.opened == 1
    scenes.close()


async def test_larger_than_the_copies_may_be_is_fetched_each_time(shelf: Shelf) -> None:
    scenes = KeptScenes(7)
    scenes.shelf = shelf
    for _ in range(2):
        with (await scenes.get("a")).blob as blob:
            assert blob.read() == b"quadrics"
    assert shelf.opened == 2


async def test_while_the_store_is_away_what_is_here_is_used_and_nothing_is_kept(shelf: Shelf) -> None:
    scenes = KeptScenes(100)
    scenes.shelf = shelf
    (await scenes.get("a")).blob.close()
    shelf.away = True
    (await scenes.get("a")).blob.close()
    with pytest.raises(StorageError):
        await scenes.get("b")
    with pytest.raises(StorageError):
        await scenes.keep(KeptScene("b", 1, Blob.of(b"quadrics")))
    shelf.away = False
    with pytest.raises(UnknownSceneError):
        await scenes.get("b")
    scenes.close()
