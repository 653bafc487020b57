"""Child processes are started before they are needed, or when they are, but not where they are not."""

from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager

import pytest

from conicoid_service.blob import Blob
from conicoid_service.bodies import Body
from conicoid_service.pipeline import Pipeline
from conicoid_service.settings import Settings
from tests.service.conftest import FAKE
from tests.service.test_supervisor import until

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("nothing_left", "search_path")]

DOCUMENT = b'{"conicoid": 1, "quadrics": [], "camera": {"width": 1, "height": 1, "fov_y": 40}}'


@asynccontextmanager
async def started(warm: Iterable[str]) -> AsyncIterator[Pipeline]:
    running = Pipeline(Settings(), FAKE, warm=[*warm])
    running.start()
    try:
        yield running
    finally:
        await running.stop()


def alive(running: Pipeline) -> set[str]:
    return {name for name, pool in running.children.items() if pool.counts().alive}


async def test_only_what_is_to_be_warm_is_started() -> None:
    async with started(["document"]) as running:
        text, _ = await running.canonical(Body(Blob.of(DOCUMENT), None, ""))
        assert text.startswith(b'{"conicoid":1')
        assert alive(running) == {"document"}


@pytest.mark.parametrize("warm", [[], ["document"]])
async def test_what_is_not_warm_starts_when_it_is_needed(warm: list[str]) -> None:
    async with started(warm) as running:
        assert (await running.device())["threads"] == 1
        await until(lambda: alive(running) == {"render", *warm})


async def test_a_child_that_was_never_started_stops() -> None:
    async with started([]) as running:
        assert alive(running) == set()
