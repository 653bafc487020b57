"""A farm under test: an API and workers as processes of their own."""

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

import httpx

from tests.checkout import BIN
from tests.farm.network import Network
from tests.farm.processes import Process, server_port
from tests.running import Service


class Worker:
    """`conicoid worker` with one process for rendering.

    Args:
        network: in which it is instead of the machine's.
    """

    def __init__(self, log: Path, environment: Mapping[str, str], network: Network | None = None) -> None:
        self.log, self._inside = log, network.inside if network else ()
        self._address, self._port = network.peer if network else "127.0.0.1", server_port()
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
        """Whether it says that it takes units."""
        with suppress(httpx.TransportError):
            return httpx.get(f"http://{self._address}:{self._port}/readyz").status_code == 200
        return False

    @property
    def process(self) -> Process:
        assert self._process is not None, "it does not run"
        return self._process

    def pool_child(self) -> int:
        """Its child that takes units and has the render process."""
        return self.process.children()[0]

    def kill(self) -> None:
        """End it and its children as a power failure would."""
        self.process.kill()

    def stop(self) -> int:
        """Let it end its unit and go; its exit status."""
        return self.process.end()


class Farm:
    """An API and workers.

    Args:
        folder: for logs.
        environment: of all of them.
        workers: how many.
        networks: of the last ones, if they have their own.
    """

    def __init__(
        self, folder: Path, environment: Mapping[str, str], workers: int = 3, networks: Sequence[Network] = ()
    ) -> None:
        ends_with_tests = ("setpriv", "--pdeathsig=KILL")
        self.api = Service(folder / "data", folder / "api.log", ends_with_tests, environment)
        places = [*[None] * (workers - len(networks)), *networks]
        self.workers = [Worker(folder / f"worker{k}.log", environment, place) for k, place in enumerate(places)]
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
