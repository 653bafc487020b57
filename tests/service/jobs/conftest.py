"""A service that keeps jobs, with a render process that draws anything."""

from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import httpx
import pytest

from tests.farm.servers import Servers
from tests.service.conftest import FAKE
from tests.service.jobs import places
from tests.service.jobs.asking import serving, settings


@pytest.fixture(scope="session", autouse=True)
def farm(request: pytest.FixtureRequest) -> Iterator[None]:
    """With `--farm`, the servers of one."""
    if not request.config.getoption("--farm"):
        yield
        return
    with Servers() as servers, pytest.MonkeyPatch.context() as patch:
        for name, value in servers.store.access().items():
            patch.setenv(name, value)
        patch.setattr(places, "servers", servers)
        yield


@pytest.fixture
async def client(tmp_path: Path, search_path: None, anyio_backend: str) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    async with serving(
        settings(tmp_path, frame_limit=50, job_pixel_limit=50_000, owner_frame_limit=60), FAKE
    ) as served:
        yield served
