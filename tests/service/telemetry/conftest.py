"""A service under observation, with a render process that draws anything."""

from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest

from conicoid_service.settings import Settings
from tests.service.conftest import FAKE, serving


@pytest.fixture
async def client(tmp_path: Path, search_path: None, anyio_backend: str) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    async with serving(Settings(data_dir=tmp_path), FAKE) as served:
        yield served
