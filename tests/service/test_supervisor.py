"""A child may die in any way, at any time: its request gets a clear error after one retry, the next one works."""

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from conicoid_service.blob import Blob
from conicoid_service.child import Kind
from conicoid_service.errors import (
    QueueFullError,
    RenderCrashedError,
    RenderTimeoutError,
    ReportedError,
    StoppingError,
    UnavailableError,
)
from conicoid_service.pool import Pool
from conicoid_service.process import Process

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("nothing_left")]

FAULTY = (sys.executable, str(Path(__file__).with_name("faulty_worker.py")))


@asynccontextmanager
async def supervisor(
    configuration: dict[str, Any] | None = None,
    *,
    command: tuple[str, ...] = FAULTY,
    queue_length: int = 8,
    deadline_s: float = 60,
    start_deadline_s: float = 60,
) -> AsyncIterator[Pool]:
    kind = Kind("render", command, configuration or {}, deadline_s, start_deadline_s)
    running = Pool(kind, queue_length=queue_length, owner_queue_length=queue_length)
    running.start()
    try:
        yield running
    finally:
        await asyncio.to_thread(running.stop)


def test_child_gets_no_keys_of_servers_that_it_does_not_talk_to(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("PGPASSWORD", "PGPASSFILE", "AWS_SECRET_ACCESS_KEY", "AZURE_STORAGE_KEY", "GOOGLE_SERVICE_ACCOUNT"):
        monkeypatch.setenv(name, "a secret")
    child = Process([sys.executable, "-c", "import time; time.sleep(60)"])
    try:
        assert b"a secret" not in Path(f"/proc/{child.pid}/environ").read_bytes()
    finally:
        child.end(grace_s=0)


async def echo(running: Pool) -> int:
    """The pid that answered."""
    return int((await running.call({"do": "echo"})).message["pid"])


async def until(condition: Callable[[], bool]) -> None:
    """Wait for what must come; a test that hangs here has failed."""
    async with asyncio.timeout(30):
        while not condition():  # noqa: ASYNC110  # the state of another process has no event
            await asyncio.sleep(0.01)


async def test_request_and_reply_carry_blobs_of_any_size() -> None:
    data = os.urandom(3_000_001)
    async with supervisor() as running:
        answer = await running.call({"do": "echo"}, [Blob.of(b""), Blob.of(data)])
        assert [blob.read() for blob in answer.blobs] == [b"", data]
        for blob in answer.blobs:
            blob.close()


async def test_requests_made_before_the_child_is_ready_wait_for_it() -> None:
    async with supervisor() as running:
        assert not running.ready
        await echo(running)
        assert running.ready


async def test_starting_again_changes_nothing() -> None:
    async with supervisor() as running:
        first = await echo(running)
        running.start()
        assert await echo(running) == first


@pytest.mark.parametrize(
    ("fault", "cause"),
    [("abort", "SIGABRT"), ("segfault", "SIGSEGV"), ("kill", "SIGKILL"), ("exit", "exit status 3")],
)
async def test_a_request_that_kills_every_child_fails_alone_and_says_how(fault: str, cause: str) -> None:
    async with supervisor() as running:
        first = await echo(running)
        with pytest.raises(RenderCrashedError, match=cause):
            await running.call({"do": fault}, [Blob.of(b"poison")])
        assert await echo(running) != first


@pytest.mark.parametrize("fault", ["abort once", "segfault once", "kill once", "exit once"])
async def test_a_request_whose_child_dies_once_succeeds_on_a_fresh_one(fault: str, tmp_path: Path) -> None:
    async with supervisor() as running:
        first = await echo(running)
        answer = await running.call({"do": fault, "mark": str(tmp_path / "mark")}, [Blob.of(b"data")])
        assert answer.message["pid"] != first
        assert answer.blobs[0].read() == b"data"
        answer.blobs[0].close()


async def test_a_request_that_hangs_is_ended_by_the_deadline_twice() -> None:
    async with supervisor(deadline_s=0.3) as running:
        first = await echo(running)
        with pytest.raises(RenderTimeoutError, match=r"deadline of 0\.3 s"):
            await running.call({"do": "hang"})
        assert await echo(running) != first


async def test_a_request_that_hangs_once_succeeds_on_a_fresh_child(tmp_path: Path) -> None:
    async with supervisor(deadline_s=1) as running:
        first = await echo(running)
        answer = await running.call({"do": "hang once", "mark": str(tmp_path / "mark")})
        assert answer.message["pid"] != first


async def test_a_child_killed_while_idle_costs_no_request() -> None:
    async with supervisor() as running:
        first = await echo(running)
        os.kill(first, signal.SIGKILL)
        assert await echo(running) != first


async def test_a_child_killed_while_idle_is_replaced_before_anyone_asks() -> None:
    async with supervisor() as running:
        os.kill(await echo(running), signal.SIGKILL)
        await until(lambda: not running.ready)
        await until(lambda: running.ready)


async def test_a_child_that_refuses_to_start_gives_its_reason_to_every_request() -> None:
    async with supervisor({"start": "refuse"}) as running:
        for _ in range(2):
            with pytest.raises(ReportedError, match="install one") as refused:
                await running.call({"do": "echo"})
            assert refused.value.code == "device-missing"
        assert not running.ready
        assert running.failure is refused.value


@pytest.mark.parametrize("command", [(*FAULTY[:1], "-c", "raise SystemExit(7)"), ("/no/such/program",)])
async def test_a_child_that_cannot_start_makes_the_service_unavailable_not_stuck(command: tuple[str, ...]) -> None:
    async with supervisor(command=command) as running:
        with pytest.raises(UnavailableError):
            await running.call({"do": "echo"}, [Blob.of(b"data")])


async def test_a_child_that_hangs_at_its_start_is_ended_by_the_start_deadline() -> None:
    async with supervisor({"start": "hang"}, start_deadline_s=0.3) as running:
        with pytest.raises(UnavailableError, match=r"deadline of 0\.3 s"):
            await running.call({"do": "echo"})


async def test_a_child_that_crashes_at_its_start_is_followed_by_one_that_is_told_so(tmp_path: Path) -> None:
    async with supervisor({"start": "crash once", "mark": str(tmp_path / "mark")}) as running:
        await echo(running)
        assert (await running.hello())["after"] == "SIGABRT"


async def test_a_child_that_cannot_start_for_now_is_started_later(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    async with supervisor(command=(sys.executable, str(program))) as running:
        await until(lambda: running.failure is not None)
        program.write_text(f"import runpy; runpy.run_path({FAULTY[1]!r}, run_name='__main__')")
        await until(lambda: running.ready)
        assert running.failure is None


async def test_errors_that_the_child_reports_leave_it_alive() -> None:
    async with supervisor() as running:
        first = await echo(running)
        with pytest.raises(ReportedError) as scene:
            await running.call({"do": "scene"})
        with pytest.raises(ReportedError) as limit:
            await running.call({"do": "limit"})
        with pytest.raises(ReportedError) as defect:
            await running.call({"do": "defect"})
        assert await echo(running) == first
    assert [problem.pointer for problem in scene.value.problems] == ["quadrics[3].radius"]
    assert (limit.value.code, limit.value.limit, limit.value.asked) == ("limit", 10, 11)
    assert defect.value.code == "internal"
    assert "secret" not in str(defect.value)


async def test_the_queue_holds_as_many_as_it_says_and_frees_places() -> None:
    async with supervisor(queue_length=2) as running:
        await echo(running)
        waiting = [asyncio.create_task(running.call({"do": "echo", "seconds": 0.2})) for _ in range(3)]
        await asyncio.sleep(0)
        with pytest.raises(QueueFullError):
            await running.call({"do": "echo"}, [Blob.of(b"refused")])
        await asyncio.gather(*waiting)
        await echo(running)


async def test_a_caller_that_gives_up_frees_its_place_and_its_results() -> None:
    async with supervisor(queue_length=1) as running:
        await echo(running)
        in_child = asyncio.create_task(running.call({"do": "echo", "seconds": 0.3}, [Blob.of(b"late result")]))
        queued = asyncio.create_task(running.call({"do": "abort"}, [Blob.of(b"never sent")]))
        await asyncio.sleep(0.1)
        queued.cancel()
        in_child.cancel()
        await asyncio.wait([queued, in_child])
        first = await echo(running)
        assert first == await echo(running)


async def test_time_in_the_queue_is_counted() -> None:
    async with supervisor() as running:
        await echo(running)
        sleeping = asyncio.create_task(running.call({"do": "echo", "seconds": 0.3}))
        await asyncio.sleep(0)
        assert (await running.call({"do": "echo"})).queue_ms >= 300
        assert (await sleeping).queue_ms < 300


async def test_stopping_fails_what_runs_and_what_waits() -> None:
    async with supervisor() as running:
        await echo(running)
        calls = [asyncio.create_task(running.call({"do": "hang"}, [Blob.of(b"data")])) for _ in range(3)]
        await asyncio.sleep(0.1)
    for call in calls:
        with pytest.raises(StoppingError):
            await call
    with pytest.raises(StoppingError):
        await running.call({"do": "echo"})


async def test_stopping_does_not_wait_for_a_child_that_is_still_starting() -> None:
    async with supervisor({"start": "hang"}):
        await asyncio.sleep(0.1)


PARENT = """
import asyncio, sys
from conicoid_service.child import Kind
from conicoid_service.pool import Pool

async def main(command, do):
    running = Pool(Kind("render", command, {}, 60, 60), queue_length=1, owner_queue_length=1)
    running.start()
    try:
        print((await running.hello())["pid"], flush=True)
        await running.call({"do": do})
        await asyncio.sleep(3600)
    except Exception as error:
        print(type(error).__name__)
    await asyncio.to_thread(running.stop)

asyncio.run(main(sys.argv[2:], sys.argv[1]))
"""


def parent(do: str, command: tuple[str, ...]) -> "subprocess.Popen[str]":
    """A process with a supervisor of its own, which prints its child's pid or its error."""
    program = [sys.executable, "-c", PARENT, do, *command]
    return subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def running_process(pid: int) -> bool:
    """Whether the process exists and is not a zombie that waits for its new parent."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


@pytest.mark.parametrize("do", ["echo", "hang"])
async def test_a_parent_that_is_killed_takes_its_child_along(do: str) -> None:
    with parent(do, FAULTY) as killed:
        assert killed.stdout
        child = int(await asyncio.to_thread(killed.stdout.readline))
        await asyncio.sleep(0.1)
        killed.kill()
    await until(lambda: not running_process(child))


async def test_a_childs_standard_output_does_not_reach_the_parents() -> None:
    noisy = (sys.executable, "-c", "print('noise', flush=True); raise SystemExit(1)")
    with parent("echo", noisy) as heard:
        output, errors = await asyncio.to_thread(heard.communicate)
    assert output == "UnavailableError\n"
    assert "noise" in errors
