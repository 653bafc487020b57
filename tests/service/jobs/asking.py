"""Asking a service about jobs."""

import asyncio
import time
from typing import Any

import httpx

ENDED = ("succeeded", "failed", "cancelled")


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
