"""A farm under test: an API and workers as processes of their own."""

import os
import signal
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

import httpx

from tests.checkout import BIN
from tests.farm.processes import Process, command_line, server_port
from tests.running import Service


class Worker:
    """`conicoid worker` with one process for rendering.

    Args:
        inside: words before the command, to run it in other surroundings.
    """

    def __init__(self, log: Path, environment: Mapping[str, str], inside: tuple[str, ...] = ()) -> None:
        self.log, self._inside = log, inside
        self._port = server_port()
        self._environment = {**os.environ, **environment, "CONICOID_WORKER_PORT": str(self._port)}
        self._process: Process | None = None

    def begin(self) -> None:
        """Start it."""
        command = [str(BIN / "conicoid"), "worker", "--processes", "1"]
        self._process = Process(command, self.log, self._environment, inside=self._inside)

    def wait(self) -> None:
        """Wait until it takes units."""
        self.process.wait_until(self.ready)

    def ready(self) -> bool:
        """Whether it says that it takes units; only for one that is not in a network of its own."""
        with suppress(httpx.TransportError):
            return httpx.get(f"http://127.0.0.1:{self._port}/readyz").status_code == 200
        return False

    @property
    def process(self) -> Process:
        assert self._process is not None, "it does not run"
        return self._process

    def pool_children(self) -> list[int]:
        """Its children that are copies of itself: each takes units and has one render process."""
        return [pid for pid in self.process.children() if "conicoid worker" in command_line(pid).replace("/", " ")]

    def kill_child(self) -> bool:
        """End a child that takes units; whether there was one."""
        for pid in self.pool_children():
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
                return True
        return False

    def kill(self) -> None:
        """End it and its children as a power failure would."""
        self.process.kill()

    def stop(self) -> int:
        """Let it end its unit and go; its exit status."""
        return self.process.end()


class Farm:
    """An API and n workers, with logs in a folder."""

    def __init__(self, folder: Path, environment: Mapping[str, str], workers: int = 3) -> None:
        ends_with_tests = ("setpriv", "--pdeathsig=KILL")
        self.api = Service(folder / "data", folder / "api.log", ends_with_tests, environment)
        self.workers = [Worker(folder / f"worker{k}.log", environment) for k in range(workers)]
        self._open = ExitStack()

    def __enter__(self) -> Self:
        with ExitStack() as opened:
            opened.enter_context(self.api)
            for worker in self.workers:
                worker.begin()
                opened.callback(worker.kill)
            for worker in self.workers:
                worker.wait()
            self._open = opened.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._open.close()
