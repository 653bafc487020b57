"""Whatever is sent: no 5xx, no hang, a problem document where HTTP allows one, and a server that is as it was."""

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import httpx
import orjson
import pytest

from tests.checkout import ROOT
from tests.hostile import CASES, Hostile
from tests.hostile.case import EVIL
from tests.service.conftest import SCENE

HANG_S = 30
# The children keep memory that they free for the next document; these make them have most of what any needs.
LARGE = {"100,000 wrong quadrics", "200,000 unknown keys", "a million clips", "job: 150,000 cameras"}
GROWTH_LIMIT = 64 << 20  # bytes


@dataclass(frozen=True)
class Target:
    """A running server."""

    pid: int
    port: int

    def render(self) -> int:
        return httpx.post(f"http://127.0.0.1:{self.port}/v1/render", json=SCENE, timeout=60).status_code

    def processes(self) -> list[int]:
        tasks = Path(f"/proc/{self.pid}/task").glob("*/children")
        return [self.pid, *(int(child) for task in tasks for child in task.read_text().split())]

    def descriptors(self) -> int:
        return sum(len(list(Path(f"/proc/{pid}/fd").iterdir())) for pid in self.processes())

    def memory(self) -> int:
        pages = [int(Path(f"/proc/{pid}/statm").read_text().split()[1]) for pid in self.processes()]
        return sum(pages) * 4096


@pytest.fixture(scope="module")
def target(search_path: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:  # noqa: ARG001
    """A server that must be as it was when all the tests have done with it."""
    store = tmp_path_factory.mktemp("store")
    command = [sys.executable, str(ROOT / "tests/service/hostile_server.py"), str(store)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout
            running = Target(server.pid, int(server.stdout.readline()))
            assert running.render() == 200
            for case in CASES:
                if case.name in LARGE:
                    assert exchange(running.port, case.sent)
            time.sleep(0.1)
            processes, descriptors, memory = len(running.processes()), running.descriptors(), running.memory()
            yield running
            assert running.render() == 200
            give_up = time.monotonic() + 10
            while running.descriptors() > descriptors and time.monotonic() < give_up:
                time.sleep(0.1)
            assert (len(running.processes()), running.descriptors()) == (processes, descriptors)
            assert running.memory() < memory + GROWTH_LIMIT
        finally:
            server.send_signal(signal.SIGTERM)
            server.wait(30)


def exchange(port: int, sent: bytes) -> bytes:
    """All that the server answers until it closes, or until its first final answer is complete."""
    with socket.create_connection(("127.0.0.1", port), timeout=HANG_S) as bare:
        received = b""
        with suppress(ConnectionResetError, BrokenPipeError):
            bare.sendall(sent)
        with suppress(ConnectionResetError):
            while not complete(received) and (chunk := bare.recv(1 << 16)):
                received += chunk
        return received


def complete(received: bytes) -> bool:
    """Whether there is a whole final answer."""
    head, blank, body = without_continue(received).partition(b"\r\n\r\n")
    length = [line for line in head.lower().split(b"\r\n") if line.startswith(b"content-length:")]
    return bool(blank and length) and len(body) >= int(length[0].split(b":")[1])


def without_continue(received: bytes) -> bytes:
    return received.removeprefix(b"HTTP/1.1 100 Continue\r\n\r\n")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_hostile_request_is_refused_and_changes_nothing(target: Target, case: Hostile) -> None:
    answer = without_continue(exchange(target.port, case.sent))
    head, _, body = answer.partition(b"\r\n\r\n")
    assert EVIL not in head.lower()
    if answer or not case.name.startswith("no HTTP"):
        status = int(head.split()[1])
        assert status in case.statuses, answer[:500]
        if status >= 400 and b"method: HEAD" not in case.name.encode():
            assert b"content-type: application/problem+json" in head.lower()
            assert orjson.loads(body)["status"] == status
    assert target.render() == 200


def test_names_of_hostile_requests_are_unique() -> None:
    assert len({case.name for case in CASES}) == len(CASES)
