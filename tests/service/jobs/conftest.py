"""A service that keeps jobs, with a render process that draws anything."""

from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest

from tests.service.conftest import FAKE, serving
from tests.service.jobs.asking import settings


@pytest.fixture
async def client(tmp_path: Path, search_path: None, anyio_backend: str) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    async with serving(
        settings(tmp_path, frame_limit=50, job_pixel_limit=50_000, owner_frame_limit=60), FAKE
    ) as served:
        yield served
