"""Processes of a farm: ended with all that they started, and with the process that started them, however it ends."""

import os
import random
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

# Below the ports that the kernel gives to clients: one that tries to reach a server which is down could otherwise
# be given the server's own port, and keep it.
_PORTS = range(20_000, 32_000)


def server_port(address: str = "127.0.0.1") -> int:
    """A port at an address that nobody listens at, and that stays free while its server is down."""
    while True:
        port = random.choice(_PORTS)
        with suppress(OSError), socket.create_server((address, port)):
            return port


def until(holds: Callable[[], bool], what: str, seconds: float = 60.0) -> None:
    """Wait until something holds.

    Raises:
        AssertionError: it does not in time.
    """
    deadline = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < deadline, f"after {seconds:g} s not yet: {what}"
        time.sleep(0.02)


def descendants(pid: int) -> Iterator[int]:
    """A process's children, theirs, and so on."""
    with suppress(OSError):  # it has ended since
        for thread in Path(f"/proc/{pid}/task").iterdir():
            for child in map(int, (thread / "children").read_text().split()):
                yield child
                yield from descendants(child)


def cpu_s(pid: int) -> float:
    """Seconds of all CPUs that a process, its children that are there, and those that it has waited for, have used."""
    total = 0.0
    for one in (pid, *descendants(pid)):
        with suppress(OSError):
            words = Path(f"/proc/{one}/stat").read_text().rpartition(")")[2].split()
            total += sum(map(int, words[11:15])) / os.sysconf("SC_CLK_TCK")
    return total


class Process:
    """A command as a process in a session of its own.

    Args:
        user: who it runs as where the tests run as root.
        inside: words before the command, to run it in other surroundings.
    """

    def __init__(
        self,
        command: list[str],
        log: Path,
        environment: Mapping[str, str],
        user: str | None = None,
        inside: tuple[str, ...] = (),
    ) -> None:
        # The kernel forgets what a process asked for when its user changes, and so setpriv does both, in that order.
        given_up = [f"--reuid={user}", f"--regid={user}", "--init-groups"] if user and os.geteuid() == 0 else []
        words = [*inside, "setpriv", *given_up, "--pdeathsig=KILL", *command]
        with log.open("ab") as output:
            self._process = subprocess.Popen(
                words, env={**environment}, stdin=subprocess.DEVNULL, stdout=output, stderr=output, cwd="/",
                start_new_session=True,
            )  # fmt: skip
        self._log = log

    @property
    def pid(self) -> int:
        return self._process.pid

    def runs(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def children(self) -> list[int]:
        """Every process that it and its children have started and that has not ended."""
        return [*descendants(self.pid)]

    def wait_until(self, holds: Callable[[], bool]) -> None:
        """Wait until it is ready as `holds` tells, and fail with its log if it ends before."""

        def ready() -> bool:
            assert self.runs(), f"ended with {self._process.returncode}:\n{self._log.read_text(errors='replace')}"
            return holds()

        until(ready, f"ready: {self._process.args!r}, log {self._log}")

    def end(self, how: signal.Signals = signal.SIGTERM, seconds: float = 30.0) -> int:
        """Ask it to end; its exit status. Kills it, and fails, if it takes longer."""
        self._process.send_signal(how)
        try:
            return self._process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            self.kill()
            raise

    def kill(self) -> None:
        """End it and all that it started as a power failure would."""
        if not self.runs():
            return
        family = [self.pid, *self.children()]
        for pid in family:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._process.wait()
        until(lambda: not any(lives(pid) for pid in family[1:]), "every child ended")


def lives(pid: int) -> bool:
    """Whether a process exists and is no zombie that waits for its parent."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return False
