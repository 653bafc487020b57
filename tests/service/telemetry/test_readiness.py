"""`/readyz` fails for each thing that a request needs, names it, and comes back by itself."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from conicoid_service.app import create_app
from conicoid_service.errors import StorageError
from conicoid_service.pipeline import Pipeline
from conicoid_service.settings import Settings
from tests.service.conftest import FAKE
from tests.service.test_http import assert_problem

pytestmark = pytest.mark.anyio


@pytest.fixture
async def app(tmp_path: Path, search_path: None, anyio_backend: str) -> AsyncIterator[FastAPI]:  # noqa: ARG001
    settings = Settings(data_dir=tmp_path)
    served = create_app(settings, Pipeline(settings, FAKE))
    async with served.router.lifespan_context(served):
        await asyncio.gather(*(child.hello() for child in served.state.pipeline.children.values()))
        yield served


async def ready(app: FastAPI) -> httpx.Response:
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://conicoid") as client:
        return await client.get("/readyz")


def checks(response: httpx.Response) -> dict[str, Any]:
    found: dict[str, Any] = response.json()["checks"]
    return found


async def test_all_checks_are_listed_when_ready(app: FastAPI) -> None:
    response = await ready(app)
    assert response.status_code == 200
    assert checks(response) == dict.fromkeys(("draining", "document", "render", "queue", "storage"), "ok")


async def test_a_service_that_is_about_to_end_is_not_ready_though_all_of_it_works(app: FastAPI) -> None:
    app.state.readiness.draining = True
    response = await ready(app)
    assert_problem(response, 503, "stopping")
    assert [name for name, what in checks(response).items() if what != "ok"] == ["draining"]


@pytest.mark.parametrize("refusal", [StorageError("full"), NotADirectoryError("images")])
async def test_a_disk_that_takes_nothing_makes_it_unready_until_it_does(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch, refusal: Exception
) -> None:
    async def refuses() -> None:
        raise refusal

    with monkeypatch.context() as patch:
        patch.setattr(app.state.jobs, "check", refuses)
        response = await ready(app)
    assert_problem(response, 503, "storage")
    assert [name for name, what in checks(response).items() if what != "ok"] == ["storage"]
    monkeypatch.setattr(app.state.readiness, "_disk_checked", 0.0)  # as after two seconds
    assert (await ready(app)).status_code == 200


async def test_however_often_it_is_asked_the_disk_is_written_to_once_in_two_seconds(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    async def takes() -> None:
        asked.append(1)

    monkeypatch.setattr(app.state.jobs, "check", takes)
    await asyncio.gather(*(ready(app) for _ in range(20)))
    assert len(asked) == 1
