"""What the service's tests share: applications with and without OpenCL, and the check that nothing is left behind."""

import os
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import pytest

from conicoid_service.app import create_app
from conicoid_service.pipeline import Commands, Pipeline
from conicoid_service.settings import Settings
from tests.checkout import ROOT

FAKE = Commands(render=(sys.executable, str(ROOT / "tests/service/fake_render_worker.py")))

SCENE: dict[str, Any] = {
    "conicoid": 1,
    "quadrics": [{"shape": "sphere", "center": [0, 0, -3]}],
    "camera": {"width": 40, "height": 30, "fov_y": 60},
}
_IDS = count(2)


def uncached(**changes: Any) -> Settings:
    """Settings with which every request is rendered, even one for an image that was rendered already."""
    return Settings(image_cache_limit=0, **changes)


def renamed(name: str) -> dict[str, Any]:
    """The scene with a name, which is no part of its image."""
    return SCENE | {"quadrics": [{"shape": "sphere", "center": [0, 0, -3], "name": name}]}


def named(name: str) -> dict[str, Any]:
    """A scene like no other, with a name that tells the fake render process what to do."""
    return SCENE | {"quadrics": [{"shape": "sphere", "center": [0, 0, -3], "name": name, "id": next(_IDS)}]}


@asynccontextmanager
async def serving(settings: Settings, commands: Commands | None = None) -> AsyncIterator[httpx.AsyncClient]:
    """A client of an application in this process, with its lifespan run, and a job store of its own."""
    with TemporaryDirectory() as folder:
        if settings.data_dir == Settings().data_dir:
            settings = replace(settings, data_dir=Path(folder))
        async with _served(settings, commands) as client:
            yield client


@asynccontextmanager
async def _served(settings: Settings, commands: Commands | None) -> AsyncIterator[httpx.AsyncClient]:
    app = create_app(settings, Pipeline(settings, commands))
    transport = httpx.ASGITransport(app, raise_app_exceptions=True)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://conicoid", timeout=60) as client,
    ):
        yield client


@pytest.fixture(scope="session")
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="session")
def search_path() -> Iterator[None]:
    """Lets child processes import the tests' own modules."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(ROOT), prepend=os.pathsep)
        yield


@pytest.fixture(scope="module")
async def client(anyio_backend: str, search_path: None) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    """An application whose render process is fake, shared by the tests of a module."""
    limits = uncached(body_limit=2_000_000, quadric_limit=100, pixel_limit=5_000, kept_limit=100_000)
    async with serving(limits, FAKE) as shared:
        yield shared


def descriptors() -> set[str]:
    """What this process holds open that a child or a blob may have left: sockets, anonymous files."""
    held = set()
    for entry in Path("/proc/self/fd").iterdir():
        try:
            target = str(entry.readlink())
        except FileNotFoundError:
            continue  # the listing's own descriptor
        if target.startswith(("/memfd:conicoid", "socket:")):
            held.add(target)
    return held


def children() -> set[int]:
    """Processes whose parent is this one, zombies included."""
    found: set[int] = set()
    for thread in Path("/proc/self/task").iterdir():
        with suppress(FileNotFoundError):  # the thread has ended since; its children are another's now
            found |= {int(pid) for pid in (thread / "children").read_text().split()}
    return found


@pytest.fixture
def nothing_left() -> Iterator[None]:
    """Fails a test that leaves a process, a zombie, a socket or a blob behind."""
    before = children(), descriptors()
    yield
    assert children() <= before[0]
    assert descriptors() <= before[1]
