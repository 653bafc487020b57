"""Batches, and asking a service about them."""

import asyncio
import json
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx

from conicoid_service.jobs.files import Files, files_at
from conicoid_service.pipeline import Commands
from conicoid_service.settings import Settings
from tests.farm.hand import working
from tests.service.conftest import SCENE, named
from tests.service.conftest import serving as _serving
from tests.service.jobs import places

VIEW = SCENE["camera"]
ENDED = ("succeeded", "failed", "cancelled")


def batch(frames: int, name: str = "", **more: Any) -> dict[str, Any]:
    """A scene seen by cameras that each look a little further."""
    document = {key: value for key, value in named(name).items() if key != "camera"}
    return document | {"cameras": [{**VIEW, "far": 10.0 + k} for k in range(frames)]} | more


def settings(folder: Path, **changes: Any) -> Settings:
    """Of a store that is the folder's own."""
    changes |= places.of(folder)
    return replace(Settings(data_dir=folder / "store", image_cache_limit=0), **changes)


@asynccontextmanager
async def serving(settings: Settings, commands: Commands) -> AsyncIterator[httpx.AsyncClient]:
    """As in `tests.service.conftest`, and for a farm a worker."""
    async with _serving(settings, commands) as client:
        with working(settings, commands) if settings.farm else nullcontext():
            yield client


def stored(settings: Settings, kind: str) -> Files:
    """The files of the store, beside whoever uses them."""
    return files_at(settings.object_store or settings.data_dir.as_uri(), kind, "")


async def in_state(client: httpx.AsyncClient, href: str, *states: str) -> dict[str, Any]:
    """The job once it is in one of some states."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        job: dict[str, Any] = (await client.get(href)).json()
        if job["state"] in states:
            return job
        await asyncio.sleep(0.02)
    raise AssertionError(f"not in {states}: {job}")


async def ended(client: httpx.AsyncClient, href: str) -> dict[str, Any]:
    """The job once it has ended."""
    return await in_state(client, href, *ENDED)


async def submit(client: httpx.AsyncClient, document: object, **headers: str) -> dict[str, Any]:
    response = await client.post("/v1/jobs", json=document, headers=headers)
    assert response.status_code == 202, response.text
    job: dict[str, Any] = response.json()
    assert response.headers["location"] == job["href"]
    return job


def events_of(text: str) -> list[tuple[str, str | None, Any]]:
    """Name, id and data of each event."""
    found = []
    for block in text.split("\n\n"):
        fields = dict(line.split(": ", 1) for line in block.splitlines() if not line.startswith(":"))
        if fields:
            found.append((fields["event"], fields.get("id"), json.loads(fields["data"])))
    return found
