"""Every request moves exactly the counters that are about it, and no client can make a label's value."""

import asyncio
from dataclasses import replace
from pathlib import Path

import httpx
import pytest

from conicoid_service.settings import Settings
from conicoid_service.telemetry.watched import Readers, Readings
from tests.service.conftest import FAKE, SCENE, named, serving
from tests.service.telemetry.scraped import sample, scraped

pytestmark = pytest.mark.anyio

RENDER = "/v1/render"


async def test_a_render_is_counted_with_its_stages_pixels_and_bytes(client: httpx.AsyncClient) -> None:
    before = await scraped(client)
    image = await client.post(RENDER, json=SCENE)
    after = await scraped(client)
    after.subtract(before)
    assert after[sample("requests_total", route=RENDER, method="POST", status="200")] == 1
    assert after[sample("request_seconds_count", route=RENDER)] == 1
    for process, stages in {"document": ("queue", "parse", "setup"), "render": ("queue", "setup", "cast")}.items():
        for stage in stages:
            assert after[sample("stage_seconds_count", process=process, stage=stage)] == 1
    assert after[sample("stage_seconds_sum", process="render", stage="encode")] == pytest.approx(0.003)
    assert after[sample("pixels_total")] == 40 * 30
    assert after[sample("quadrics_total")] == 1
    assert after[sample("escalated_pixels_total", how="refined")] == 7
    assert after[sample("escalated_pixels_total", how="settled")] == 4
    assert after[sample("received_bytes_total")] == int(image.request.headers["content-length"])
    assert after[sample("sent_bytes_total")] > len(image.content)
    assert after[sample("requests_in_progress")] == 0


async def test_each_image_is_counted_once_by_where_it_came_from(client: httpx.AsyncClient) -> None:
    tag = (await client.post(RENDER, json=SCENE)).headers["etag"]
    await client.post(RENDER, json=SCENE)
    await client.post(RENDER, json=SCENE, headers={"If-None-Match": tag})
    twice = named("sleep 0.3")
    await asyncio.gather(client.post(RENDER, json=twice), client.post(RENDER, json=twice))
    found = await scraped(client)
    counts = {
        source: found[sample("images_total", source=source)] for source in ("rendered", "memory", "304", "shared")
    }
    assert counts == {"rendered": 2, "memory": 1, "304": 1, "shared": 1}
    assert found[sample("images_kept_bytes")] > 0


async def test_what_clients_make_up_adds_no_label_values(client: httpx.AsyncClient) -> None:
    for k in range(3):
        await client.get(f"/nothing/{k}")
        await client.get(f"/v1/scenes/{k}")
        await client.request(f"ODD{k}", RENDER)
    found = await scraped(client)
    assert found[sample("requests_total", route="other", method="GET", status="404")] == 3
    assert found[sample("requests_total", route="/v1/scenes/{scene_id}", method="GET", status="404")] == 3
    assert found[sample("requests_total", route=RENDER, method="other", status="405")] == 3
    assert not [labels for _, labels in found for _, value in labels if "nothing" in value or "ODD" in value]


async def test_refusals_are_counted_by_code(client: httpx.AsyncClient) -> None:
    await client.post(RENDER, json=SCENE | {"quadrics": [{"shape": "sphere", "radius": -1}]})
    await client.post(RENDER, content=b"{", headers={"Content-Type": "application/json"})
    found = await scraped(client)
    assert found[sample("refusals_total", code="scene-value")] == 1
    assert found[sample("refusals_total", code="scene-json")] == 1


async def test_a_process_that_dies_is_counted_by_cause_and_each_retry_once(client: httpx.AsyncClient) -> None:
    assert (await client.post(RENDER, json=named("abort"))).status_code == 500
    found = await scraped(client)
    assert found[sample("losses_total", cause="SIGABRT")] == 2
    assert found[sample("retries_total")] == 1


async def test_jobs_and_frames_are_counted_by_state_and_outcome(client: httpx.AsyncClient) -> None:
    job = (await client.post("/v1/jobs", json=SCENE)).json()
    async with asyncio.timeout(30):
        while (await client.get(job["href"])).json()["state"] != "succeeded":  # noqa: ASYNC110  # as a client waits
            await asyncio.sleep(0.02)
    found = await scraped(client)
    assert found[sample("jobs", state="succeeded")] == 1
    assert found[sample("jobs", state="running")] == 0
    assert found[sample("frames", state="succeeded")] == 1
    assert found[sample("frames_ended_total", outcome="succeeded")] == 1
    assert (
        found[sample("store_bytes")] == (await client.get(f"{job['href']}?frame_limit=1")).json()["frames"][0]["bytes"]
    )
    assert found[sample("store_limit_bytes")] == Settings().store_limit


async def test_applications_count_for_themselves(client: httpx.AsyncClient, tmp_path: Path) -> None:
    async with serving(replace(Settings(), data_dir=tmp_path / "other"), FAKE) as other:
        await client.get("/v1/nothing")
        assert sample("refusals_total", code="not-found") not in await scraped(other)


async def test_a_reader_that_fails_takes_only_its_own_metric_away(caplog: pytest.LogCaptureFixture) -> None:
    def broken() -> Readings:
        raise OSError("the disk")

    readers = Readers()
    readers.watch("conicoid_jobs", broken)
    readers.watch("conicoid_frames", lambda: {"queued": 3})
    assert [family.name for family in await readers.read()] == ["conicoid_frames"]
    assert "conicoid_jobs cannot be read" in caplog.text


async def test_what_waits_is_counted_by_class_and_its_age_grows(client: httpx.AsyncClient, tmp_path: Path) -> None:
    go = tmp_path / "go"
    requests = []
    for scene in (named(f"until {go}"), named("")):  # the first is rendered, the second waits
        requests.append(asyncio.create_task(client.post(RENDER, json=scene)))
        await asyncio.sleep(0.5)
    first = await scraped(client)
    second = await scraped(client)
    go.touch()
    assert [(await one).status_code for one in requests] == [200, 200]
    last = await scraped(client)
    waiting = [one[sample("queue_requests", **{"class": "interactive"})] for one in (first, second, last)]
    assert waiting == [1, 1, 0]
    assert first[sample("queue_requests", **{"class": "batch"})] == 0
    ages = [one[sample("queue_oldest_seconds", **{"class": "interactive"})] for one in (first, second, last)]
    assert 0 < ages[0] < ages[1]
    assert ages[2] == 0
