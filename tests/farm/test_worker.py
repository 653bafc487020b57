"""The worker as a command, and how its images are fetched."""

import io
import json
import os
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import httpx
import pytest

from conicoid_client import Client
from tests.checkout import BIN, ROOT
from tests.farm.farm import Farm
from tests.farm.processes import until

SCENE: dict[str, Any] = json.loads((ROOT / "examples/shapes.json").read_text("utf-8"))
SCENE["camera"] |= {"width": 64, "height": 64}


def run_worker(environment: Mapping[str, str], *arguments: str) -> "subprocess.CompletedProcess[str]":
    command = [str(BIN / "conicoid"), "worker", *arguments]
    return subprocess.run(
        command, env={**os.environ, **environment}, capture_output=True, text=True, timeout=100, check=False
    )


def test_worker_without_a_farm_says_what_it_needs() -> None:
    ended = run_worker({})
    assert (ended.returncode, ended.stdout) == (1, "")
    assert "CONICOID_BROKER_URL, CONICOID_DATABASE_URL and CONICOID_OBJECT_STORE" in ended.stderr


def test_queue_that_there_is_not_is_bad_usage(environment: dict[str, str]) -> None:
    ended = run_worker(environment, "--queues", "normal,urgent")
    assert ended.returncode == 2
    assert "normal,urgent" in ended.stderr


def test_worker_without_a_broker_says_so_and_does_not_tell_the_password(environment: dict[str, str]) -> None:
    away = environment | {"CONICOID_BROKER_URL": "amqp://somebody:secret@127.0.0.1:1/"}
    ended = run_worker(away, "--once")
    assert ended.returncode == 1
    assert "the broker" in ended.stderr
    assert "secret" not in ended.stderr


def test_one_unit_is_rendered_and_another_call_finds_none(tmp_path: Path, environment: dict[str, str]) -> None:
    with Farm(tmp_path, environment, workers=0) as farm, Client(farm.api.url) as client:
        job = client.submit(SCENE, priority="high")
        assert run_worker(environment, "--once", "--queues", "normal").returncode == 0
        assert client.job(job.id).state == "queued"
        assert run_worker(environment, "--once").returncode == 0
        assert client.job(job.id).state == "succeeded"
        again = run_worker(environment, "--once")
        assert again.returncode == 0
        assert "no unit waits" in again.stderr


def test_worker_that_can_render_nothing_gives_its_unit_back_and_ends(
    tmp_path: Path, environment: dict[str, str]
) -> None:
    unable = environment | {"CONICOID_DEVICE": "no such device"}
    with Farm(tmp_path, environment, workers=0) as farm, Client(farm.api.url) as client:
        job = client.submit(SCENE)
        ended = run_worker(unable)
        assert ended.returncode == 1
        assert "no such device" in ended.stderr
        assert client.job(job.id).state == "queued"
        until(
            lambda: run_worker(environment, "--once").returncode == 0 and client.job(job.id).state == "succeeded",
            "the frame",
        )


def test_worker_that_is_told_to_end_ends_its_unit(tmp_path: Path, environment: dict[str, str]) -> None:
    document = {key: value for key, value in SCENE.items() if key != "camera"}
    document["cameras"] = [SCENE["camera"] | {"far": 100.0 + k} for k in range(300)]
    with Farm(tmp_path, environment, workers=1) as farm, Client(farm.api.url) as client:
        job = client.submit(document)
        until(lambda: client.job(job.id).frames_done >= 5, "five frames")
        assert farm.workers[0].stop() == 0
        left = client.job(job.id)
        assert left.frames_failed == 0
        assert [frame.state for frame in client.frames(job.id)].count("running") == 0
        assert left.frames_done < 300


@pytest.mark.parametrize("key", ["", "secret-of-a-test"])
def test_images_are_fetched_from_the_object_store(tmp_path: Path, environment: dict[str, str], key: str) -> None:
    keys = {"CONICOID_API_KEYS": f"tester={key}"} if key else {}
    redirecting = environment | {"CONICOID_DOWNLOAD_REDIRECT_S": "60"} | keys
    with Farm(tmp_path, redirecting, workers=1) as farm, Client(farm.api.url, api_key=key or None) as client:
        job = client.submit(SCENE)
        client.wait(job.id)
        authorization = {"Authorization": f"Bearer {key}"} if key else {}
        answer = httpx.get(f"{farm.api.url}/v1/jobs/{job.id}/frames/0", headers=authorization)
        assert answer.status_code == 307
        assert answer.headers["location"].startswith(environment["AWS_ENDPOINT_URL"])
        rendered = client.render(SCENE)
        image = client.frame(job.id, 0)
        assert (image.exr, image.etag) == (rendered.exr, rendered.etag)
        assert client.frame(job.id, 0, etag=rendered.etag or "") is None
        file = io.BytesIO()
        assert client.save_frame(job.id, 0, file) == rendered.etag
        assert file.getvalue() == rendered.exr
