"""Several child processes behind one line: who waits for whom, and what one request costs the others."""

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from conicoid_service.blob import Blob
from conicoid_service.child import Kind
from conicoid_service.errors import RenderCrashedError, ReportedError, StoppingError
from conicoid_service.memory import usable_memory
from conicoid_service.pool import PATIENCE_S, Pool
from tests.service.test_supervisor import FAULTY, echo, until

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("nothing_left")]


@asynccontextmanager
async def pool(processes: int = 1, recycle_after: int = 0) -> AsyncIterator[Pool]:
    running = Pool(
        Kind("render", FAULTY, {}, 60, 60, recycle_after), queue_length=8, owner_queue_length=8, processes=processes
    )
    running.start()
    try:
        await until(lambda: running.counts().alive == processes)
        yield running
    finally:
        await asyncio.to_thread(running.stop)


async def test_a_cancelled_request_that_runs_frees_the_child_within_a_second_and_is_not_tried_again() -> None:
    async with pool() as running:
        hanging = asyncio.create_task(running.call({"do": "hang"}, [Blob.of(b"data")]))
        await asyncio.sleep(0.1)
        hanging.cancel()
        started = time.monotonic()
        await asyncio.wait([hanging])
        await until(lambda: running.counts().ended["cancelled"] == 1)
        assert PATIENCE_S <= time.monotonic() - started < 1
        await echo(running)
        assert running.counts().retries == 0


async def test_a_poison_request_fails_alone_while_the_other_process_works() -> None:
    async with pool(2) as running:
        results = await asyncio.gather(
            *(running.call({"do": do}) for do in ["echo", "abort", "echo", "echo"]), return_exceptions=True
        )
        assert [type(result) for result in results].count(RenderCrashedError) == 1
        assert isinstance(results[1], RenderCrashedError)
        assert (running.counts().ended["crash"], running.counts().retries) == (2, 1)


async def test_processes_work_at_the_same_time() -> None:
    async with pool(2) as running:
        answers = await asyncio.gather(*(running.call({"do": "echo", "seconds": 0.3}) for _ in range(2)))
        assert len({answer.message["pid"] for answer in answers}) == 2


async def test_a_batch_delays_an_interactive_request_by_no_more_than_what_runs() -> None:
    async with pool() as running:
        ended: list[str] = []

        async def ask(name: str, *, batch: bool) -> None:
            await running.call({"do": "echo", "seconds": 0.1}, batch=batch)
            ended.append(name)

        batch = [asyncio.create_task(ask("batch", batch=True)) for _ in range(3)]
        await asyncio.sleep(0.05)
        assert (running.counts().waiting.batch, running.counts().waiting.interactive) == (2, 0)
        await ask("interactive", batch=False)
        await asyncio.gather(*batch)
        assert ended == ["batch", "interactive", "batch", "batch"]


async def test_an_old_process_is_replaced_between_requests_and_none_fails() -> None:
    async with pool(recycle_after=3) as running:
        first = await echo(running)
        async with asyncio.timeout(30):
            while await echo(running) == first:  # noqa: ASYNC110  # the state of another process has no event
                await asyncio.sleep(0.01)
        counts = running.counts()
        assert (counts.ended["recycled"] >= 1, counts.ended["crash"], counts.retries) == (True, 0, 0)


async def test_a_request_that_needs_too_much_memory_is_told_so_and_the_process_goes_on() -> None:
    async with pool() as running:
        first = await echo(running)
        with pytest.raises(ReportedError, match=r"1,073,741,824 bytes.*CONICOID_RENDER_MEMORY_LIMIT") as refused:
            await running.call({"do": "memory"})
        assert refused.value.code == "memory"
        assert await echo(running) == first


async def test_stopping_lets_what_runs_end_and_fails_what_waits() -> None:
    async with pool() as running:
        runs = asyncio.create_task(running.call({"do": "echo", "seconds": 0.5}))
        await asyncio.sleep(0.1)
        waits = asyncio.create_task(running.call({"do": "echo"}, batch=True))
        await asyncio.sleep(0)
    assert (await runs).message["pid"]
    with pytest.raises(StoppingError):
        await waits


def test_memory_is_the_smallest_limit_of_any_cgroup_version(tmp_path: Path) -> None:
    for name, limit in (("a/memory.max", "max"), ("memory.max", "3000"), ("memory/memory.limit_in_bytes", "2000")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(limit)
    for membership, expected in (("0::/a\n", 3000), ("4:memory:/\n0::/a\n", 2000)):
        (tmp_path / "membership").write_text(membership)
        assert usable_memory(tmp_path, tmp_path / "membership") == expected
