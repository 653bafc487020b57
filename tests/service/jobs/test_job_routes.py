"""Jobs over HTTP, with a render process that draws anything or does what a quadric's name says."""

import asyncio
import json
import os
import time
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from conicoid_service.settings import Settings
from tests.service.conftest import FAKE, SCENE, named, serving
from tests.service.jobs.asking import ended, in_state, submit
from tests.service.test_http import assert_problem

pytestmark = pytest.mark.anyio

VIEW = SCENE["camera"]


def batch(frames: int, name: str = "", **more: Any) -> dict[str, Any]:
    """A scene seen by cameras that each look a little further."""
    document = {key: value for key, value in named(name).items() if key != "camera"}
    return document | {"cameras": [{**VIEW, "far": 10.0 + k} for k in range(frames)]} | more


def settings(folder: Path, **changes: Any) -> Settings:
    return replace(Settings(data_dir=folder / "store", image_cache_limit=0), **changes)


@pytest.fixture
async def client(tmp_path: Path, search_path: None, anyio_backend: str) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    async with serving(
        settings(tmp_path, frame_limit=50, job_pixel_limit=50_000, owner_frame_limit=60), FAKE
    ) as served:
        yield served


async def test_every_frame_of_a_job_is_what_a_render_of_its_camera_gives(client: httpx.AsyncClient) -> None:
    document = batch(3)
    job = await submit(client, document)
    assert (job["state"], job["frames_total"], job["frames_done"], job["finished"]) == ("queued", 3, 0, None)
    job = await ended(client, job["href"])
    assert (job["state"], job["frames_done"], job["frames_failed"]) == ("succeeded", 3, 0)
    assert job["created"] <= job["started"] <= job["finished"] < job["expires"]
    for k, frame in enumerate(job["frames"]):
        assert (frame["frame"], frame["state"], frame["error"]) == (k, "succeeded", None)
        one = {key: value for key, value in document.items() if key != "cameras"} | {"camera": document["cameras"][k]}
        rendered = await client.post("/v1/render", json=one)
        image = await client.get(frame["href"])
        assert image.status_code == 200
        assert image.content == rendered.content
        assert image.headers["etag"] == rendered.headers["etag"] == frame["etag"]
        assert len(image.content) == frame["bytes"]
        assert image.headers["content-type"] == "image/x-exr"
        told = await client.get(frame["href"], headers={"If-None-Match": frame["etag"]})
        assert (told.status_code, told.content) == (304, b"")


async def test_one_camera_makes_a_job_of_one_frame(client: httpx.AsyncClient) -> None:
    job = await ended(client, (await submit(client, named("")))["href"])
    assert (job["state"], job["frames_total"]) == ("succeeded", 1)


async def test_render_may_be_asked_for_as_a_job(client: httpx.AsyncClient) -> None:
    response = await client.post("/v1/render", json=named(""), headers={"Prefer": "wait=10, respond-async"})
    assert response.status_code == 202
    assert response.headers["preference-applied"] == "respond-async"
    assert (await ended(client, response.headers["location"]))["state"] == "succeeded"


async def test_job_of_a_kept_scene_goes_on_when_the_scene_is_dropped(client: httpx.AsyncClient) -> None:
    document = batch(2)
    kept = (await client.post("/v1/scenes", json={"conicoid": 1, "quadrics": document["quadrics"]})).json()["id"]
    job = await submit(client, {"conicoid": 1, "scene": kept, "cameras": document["cameras"]})
    assert (await client.delete(f"/v1/scenes/{kept}")).status_code == 204
    assert (await ended(client, job["href"]))["state"] == "succeeded"
    assert_problem(
        await client.post("/v1/jobs", json={"conicoid": 1, "scene": kept, "camera": VIEW}), 404, "unknown-scene"
    )


async def test_poison_frame_fails_with_its_cause_and_the_others_of_the_service_do_not(
    client: httpx.AsyncClient,
) -> None:
    poison, sound = await submit(client, named("abort")), await submit(client, batch(2))
    failed = await ended(client, poison["href"])
    assert (failed["state"], failed["frames_failed"]) == ("failed", 1)
    assert failed["frames"][0]["error"]["code"] == "render-crashed"
    problem = assert_problem(await client.get(failed["frames"][0]["href"]), 404, "frame-failed")
    assert "SIGABRT" in problem["detail"]
    assert (await ended(client, sound["href"]))["state"] == "succeeded"


async def test_defect_fails_the_frame_and_keeps_the_servers_secrets(client: httpx.AsyncClient) -> None:
    failed = await ended(client, (await submit(client, named("defect")))["href"])
    assert failed["frames"][0]["error"]["code"] == "internal"
    assert "secret" not in json.dumps(failed)


async def test_cancelled_job_ends_within_a_second_even_in_the_middle_of_a_frame(client: httpx.AsyncClient) -> None:
    job = await submit(client, batch(3, "sleep 30"))
    other = await submit(client, batch(1))
    await in_state(client, job["href"], "running")
    start = time.monotonic()
    response = await client.delete(job["href"])
    assert (response.status_code, response.json()["state"]) == (202, "cancelled")
    again = await client.delete(job["href"])
    assert (again.status_code, again.json()["finished"]) == (200, response.json()["finished"])
    shown = (await client.get(job["href"])).json()
    assert {frame["state"] for frame in shown["frames"]} == {"cancelled"}
    assert_problem(await client.get(shown["frames"][0]["href"]), 404, "frame-not-ready")
    assert (await ended(client, other["href"]))["state"] == "succeeded"
    assert time.monotonic() - start < 5  # and not the 30 s of the frame


async def test_frame_that_is_not_there_yet_says_when_to_come_back(client: httpx.AsyncClient, tmp_path: Path) -> None:
    job = await submit(client, batch(1, f"until {tmp_path / 'go'}"))
    response = await client.get(f"{job['href']}/frames/0")
    assert_problem(response, 404, "frame-not-ready")
    assert response.headers["retry-after"] == "1"
    assert_problem(await client.get(f"{job['href']}/frames/1"), 404, "frame-not-ready")
    (tmp_path / "go").touch()
    assert (await ended(client, job["href"]))["state"] == "succeeded"


async def test_same_key_makes_no_second_job_however_the_body_is_sent(client: httpx.AsyncClient) -> None:
    document = batch(1)
    first = await submit(client, document, **{"Idempotency-Key": "k1"})
    again = await client.post("/v1/jobs", json=document, headers={"Idempotency-Key": "k1"})
    assert (again.status_code, again.json()["id"]) == (200, first["id"])
    parts = {"scene": (None, json.dumps(document), "application/json")}
    multipart = await client.post("/v1/jobs", files=parts, headers={"Idempotency-Key": "k1"})
    assert (multipart.status_code, multipart.json()["id"]) == (200, first["id"])
    other = await client.post("/v1/jobs", json=batch(2), headers={"Idempotency-Key": "k1"})
    assert_problem(other, 422, "idempotency-key")
    for key in ("", "a b", "x" * 256):
        assert_problem(
            await client.post("/v1/jobs", json=document, headers={"Idempotency-Key": key}), 422, "idempotency-key"
        )


async def test_same_key_at_once_makes_one_job(client: httpx.AsyncClient) -> None:
    document = batch(1)
    posts = [client.post("/v1/jobs", json=document, headers={"Idempotency-Key": "k"}) for _ in range(8)]
    answers = await asyncio.gather(*posts)
    assert sorted(answer.status_code for answer in answers) == [200] * 7 + [202]
    assert len({answer.json()["id"] for answer in answers}) == 1


async def test_pages_and_frames_are_walked_by_next(client: httpx.AsyncClient) -> None:
    ids = [(await submit(client, batch(5)))["id"] for _ in range(5)]
    walked, following = [], "/v1/jobs?limit=2"
    while following:
        page = (await client.get(following)).json()
        walked += [job["id"] for job in page["jobs"]]
        following = page["next"]
    assert walked == ids[::-1]
    numbers, following = [], f"/v1/jobs/{ids[0]}?frame_limit=2"
    while following:
        page = (await client.get(following)).json()
        numbers += [frame["frame"] for frame in page["frames"]]
        following = page["next"]
    assert numbers == [0, 1, 2, 3, 4]
    await ended(client, f"/v1/jobs/{ids[-1]}")
    assert (await client.get("/v1/jobs?state=cancelled")).json() == {"jobs": [], "next": None}


@pytest.mark.parametrize(
    ("path", "pointer"),
    [
        ("/v1/jobs?limit=0", "query.limit"),
        ("/v1/jobs?limit=x", "query.limit"),
        ("/v1/jobs?state=done", "query.state"),
        ("/v1/jobs/a/frames/-1", "path.number"),
        ("/v1/jobs/a/frames/one", "path.number"),
        (f"/v1/jobs/{'a' * 100}", "path.job_id"),
    ],
)
async def test_unusable_parameter_is_a_problem_at_its_place(client: httpx.AsyncClient, path: str, pointer: str) -> None:
    problem = assert_problem(await client.get(path), 422, "parameter")
    assert [error["pointer"] for error in problem["errors"]] == [pointer]


async def test_unknown_job_is_a_problem_on_every_route(client: httpx.AsyncClient) -> None:
    for path in ("", "/frames/0", "/events"):
        assert_problem(await client.get(f"/v1/jobs/0{path}"), 404, "unknown-job")
    assert_problem(await client.delete("/v1/jobs/0"), 404, "unknown-job")


async def test_too_much_is_refused_before_it_is_begun(client: httpx.AsyncClient) -> None:
    problem = assert_problem(await client.post("/v1/jobs", json=batch(51)), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (50, 51)
    problem = assert_problem(await client.post("/v1/jobs", json=batch(45)), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (50_000, 54_000)
    held = await submit(client, batch(40, "sleep 30"))
    assert_problem(await client.post("/v1/jobs", json=batch(30)), 429, "job-limit")
    await client.delete(held["href"])


async def test_malformed_batch_is_a_problem_at_its_place(client: httpx.AsyncClient) -> None:
    document = batch(3)
    document["cameras"][1] = {**VIEW, "fov_y": 200}
    problem = assert_problem(await client.post("/v1/jobs", json=document), 422, "scene-value")
    assert [error["pointer"] for error in problem["errors"]] == ["cameras[1].fov_y"]
    assert_problem(await client.post("/v1/render", json=batch(1)), 422, "scene-unsupported")


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
    folder = tmp_path / "store" / "images"
    files = [next(folder.glob("*/" + frame["etag"].strip('"'))) for frame in job["frames"]]
    files[0].unlink()
    os.truncate(files[1], 100)
    files[2].write_bytes(images[2][:-1] + bytes([images[2][-1] ^ 1]))
    assert [(await client.get(href)).content for href in hrefs] == images
    assert [file.read_bytes() for file in files] == images


async def test_damaged_quadrics_fail_the_frame_with_the_remedy(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    async with serving(settings(tmp_path), FAKE) as client:
        job = await submit(client, batch(1, f"until {tmp_path / 'go'}"))
    file = next((tmp_path / "store" / "quadrics").glob("??/*"))
    file.write_bytes(file.read_bytes()[:100])
    (tmp_path / "go").touch()
    async with serving(settings(tmp_path), FAKE) as client:
        failed = await ended(client, job["href"])
        assert failed["frames"][0]["error"]["code"] == "quadrics-file"


def events_of(text: str) -> list[tuple[str, str | None, Any]]:
    """Name, id and data of each event."""
    found = []
    for block in text.split("\n\n"):
        fields = dict(line.split(": ", 1) for line in block.splitlines() if not line.startswith(":"))
        if fields:
            found.append((fields["event"], fields.get("id"), json.loads(fields["data"])))
    return found


async def test_events_tell_every_frame_once_and_the_end(client: httpx.AsyncClient) -> None:
    job = await submit(client, batch(4))
    response = await client.get(job["events"])
    assert response.headers["content-type"].startswith("text/event-stream")
    events = events_of(response.text)
    frames = [(event_id, data["frame"], data["frames_total"]) for name, event_id, data in events if name == "frame"]
    assert [event_id for event_id, _, _ in frames] == ["1", "2", "3", "4"]
    assert sorted(number for _, number, _ in frames) == [0, 1, 2, 3]
    name, event_id, data = events[-1]
    assert (name, event_id, data["state"], data["frames_done"]) == ("end", "end", "succeeded", 4)
    assert next(name for name, _, _ in events) in ("progress", "frame")


async def test_events_go_on_where_the_last_stream_was_cut(client: httpx.AsyncClient) -> None:
    job = await ended(client, (await submit(client, batch(4)))["href"])
    rest = events_of((await client.get(job["events"], headers={"Last-Event-ID": "3"})).text)
    assert [event_id for name, event_id, _ in rest if name != "progress"] == ["4", "end"]
    over = await client.get(job["events"], headers={"Last-Event-ID": "end"})
    assert (over.status_code, over.content) == (204, b"")
    for strange in ("-1", "x", "1e3", "99999999999"):
        told = events_of((await client.get(job["events"], headers={"Last-Event-ID": strange})).text)
        assert [event_id for name, event_id, _ in told if name == "frame"] == ["1", "2", "3", "4"]


async def test_expired_job_is_gone_with_its_files(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    async with serving(settings(tmp_path, result_lifetime_s=1.0, store_limit=0), FAKE) as client:
        job = await submit(client, batch(2))
        await ended(client, job["href"])
        deadline = time.monotonic() + 25
        while (await client.get(job["href"])).status_code == 200:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.2)
        while [*(tmp_path / "store" / "images").glob("??/*")]:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.2)


async def test_store_that_is_full_of_needed_images_takes_no_more_jobs(tmp_path: Path, search_path: None) -> None:  # noqa: ARG001
    async with serving(settings(tmp_path, store_limit=100), FAKE) as client:
        await ended(client, (await submit(client, batch(1)))["href"])
        response = await client.post("/v1/jobs", json=batch(1))
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
