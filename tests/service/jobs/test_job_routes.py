"""Jobs over HTTP, with a render process that draws anything or does what a quadric's name says."""

import asyncio
import json
import time
from pathlib import Path

import httpx
import pytest

from tests.service.conftest import named
from tests.service.jobs.asking import VIEW, batch, ended, in_state, submit
from tests.service.test_http import assert_problem

pytestmark = pytest.mark.anyio


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


async def test_priority_is_told_and_no_other_word_is_one(client: httpx.AsyncClient) -> None:
    assert (await submit(client, named("")))["priority"] == "normal"
    response = await client.post("/v1/jobs?priority=high", json=named(""))
    assert (response.status_code, response.json()["priority"]) == (202, "high")
    assert_problem(await client.post("/v1/jobs?priority=urgent", json=named("")), 422, "parameter")


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
