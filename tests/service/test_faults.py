"""Whatever happens to a child process, its request gets a clear problem and the next request works."""

import asyncio
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

import httpx
import pytest

from conicoid_service.pipeline import Commands
from tests.service.conftest import FAKE, SCENE, children, named, serving, uncached
from tests.service.test_http import JSON, assert_problem

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("nothing_left", "search_path")]

NO_DRIVER = """
import sys
from conicoid.errors import DeviceError
from conicoid_service.worker import serve

def start(configuration):
    raise DeviceError("no OpenCL device was found; install one")

serve(start, sys.argv[1:])
"""


async def broken_endpoint() -> None:
    raise ZeroDivisionError("a secret of the server's")


async def ready(client: httpx.AsyncClient) -> None:
    async with asyncio.timeout(60):
        while (await client.get("/readyz")).status_code != 200:  # noqa: ASYNC110  # a probe is polled
            await asyncio.sleep(0.01)


async def test_a_scene_that_aborts_the_render_process_fails_alone() -> None:
    async with serving(uncached(), FAKE) as client:
        problem = assert_problem(await client.post("/v1/render", json=named("abort")), 500, "render-crashed")
        assert "SIGABRT" in problem["detail"]
        assert (await client.post("/v1/render", json=SCENE)).status_code == 200


async def test_a_scene_that_hangs_meets_the_deadline_and_fails_alone() -> None:
    async with serving(uncached(deadline_s=1), FAKE) as client:
        assert_problem(await client.post("/v1/render", json=named("hang")), 504, "render-timeout")
        assert (await client.post("/v1/render", json=SCENE)).status_code == 200


async def test_poison_among_other_requests_takes_none_of_them_along() -> None:
    async with serving(uncached(), FAKE) as client:
        names = ["", "abort", "", "defect", "abort", ""]
        responses = await asyncio.gather(*(client.post("/v1/render", json=named(name)) for name in names))
    assert [response.status_code for response in responses] == [200, 500, 200, 500, 500, 200]


async def test_killing_every_child_again_and_again_loses_no_request() -> None:
    async with serving(uncached(), FAKE) as client:
        for _ in range(3):
            await ready(client)
            for child in children():
                os.kill(child, signal.SIGKILL)
            assert (await client.post("/v1/render", json=SCENE)).status_code == 200


async def test_a_child_killed_in_the_middle_of_a_request_is_replaced_and_the_request_answered(tmp_path: Path) -> None:
    async with serving(uncached(), FAKE) as client:
        await ready(client)
        rendering = asyncio.create_task(client.post("/v1/render", json=named(f"until {tmp_path / 'go'}")))
        await asyncio.sleep(0.2)
        for child in children():
            os.kill(child, signal.SIGKILL)
        (tmp_path / "go").touch()
        assert (await rendering).status_code == 200


async def test_while_a_render_runs_documents_are_still_read_and_known_images_still_known(tmp_path: Path) -> None:
    async with serving(uncached(), FAKE) as client:
        tag = (await client.post("/v1/render", json=SCENE)).headers["etag"]
        rendering = asyncio.create_task(client.post("/v1/render", json=named(f"until {tmp_path / 'go'}")))
        await asyncio.sleep(0.1)
        assert (await client.post("/v1/canonical", json=SCENE)).status_code == 200
        assert_problem(await client.post("/v1/render", content=b"{", headers=JSON), 400, "scene-json")
        known = await client.post("/v1/render", json=SCENE, headers={"If-None-Match": tag})
        assert known.status_code == 304
        assert not rendering.done()
        (tmp_path / "go").touch()
        assert (await rendering).status_code == 200


async def test_a_full_queue_answers_429_and_when_to_come_back(tmp_path: Path) -> None:
    async with serving(uncached(queue_length=1), FAKE) as client:
        await client.get("/v1/device")
        scenes = [named(f"until {tmp_path / 'go'}") for _ in range(2)]
        held = []
        for scene in scenes:  # one after the other: they also pass the queue of the document process
            held.append(asyncio.create_task(client.post("/v1/render", json=scene)))
            await asyncio.sleep(0.3)
        response = await client.post("/v1/render", json=SCENE)
        assert_problem(response, 429, "queue-full")
        assert int(response.headers["retry-after"]) >= 1
        (tmp_path / "go").touch()
        assert [(await request).status_code for request in held] == [200, 200]
        assert (await client.post("/v1/render", json=SCENE)).status_code == 200


async def test_without_a_device_renders_say_what_to_install_and_documents_are_still_read() -> None:
    async with serving(uncached(), replace(FAKE, render=(sys.executable, "-c", NO_DRIVER))) as client:
        problem = assert_problem(await client.post("/v1/render", json=SCENE), 503, "device-missing")
        assert "install one" in problem["detail"]
        assert_problem(await client.get("/v1/device"), 503, "device-missing")
        assert_problem(await client.get("/readyz"), 503, "device-missing")
        assert (await client.post("/v1/canonical", json=SCENE)).status_code == 200
        assert (await client.get("/livez")).status_code == 200


async def test_children_that_cannot_start_make_the_service_unavailable() -> None:
    broken = (sys.executable, "-c", "raise SystemExit(1)")
    async with serving(uncached(), Commands(broken, broken)) as client:
        for path in ("/v1/render", "/v1/canonical"):
            response = await client.post(path, json=SCENE)
            assert_problem(response, 503, "render-unavailable")
            assert int(response.headers["retry-after"]) >= 1


async def test_readiness_comes_with_the_children_and_says_what_is_missing() -> None:
    waiting = "import sys, time; time.sleep(3600)"
    async with serving(uncached(), replace(FAKE, render=(sys.executable, "-c", waiting))) as client:
        problem = assert_problem(await client.get("/readyz"), 503, "not-ready")
        assert "process is starting" in problem["detail"]
        assert (await client.get("/livez")).status_code == 200


async def test_a_defect_in_the_application_itself_is_a_problem_without_details() -> None:
    async with serving(uncached(), FAKE) as client:
        client._transport.app.get("/defect")(broken_endpoint)  # type: ignore[attr-defined]
        response = await client.get("/defect")
        assert_problem(response, 500, "internal")
        assert "secret" not in response.text
