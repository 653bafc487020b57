"""The parent's side of one child process: start it, exchange one message at a time, end it without leaving anything."""

import os
import re
import signal
import socket
import subprocess
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass

from conicoid_service.blob import Blob
from conicoid_service.channel import Channel, Message
from conicoid_service.errors import ReportedError

GRACE_S = 2.0
_STDERR = 2
# Keys of object stores and of PostgreSQL, which no child needs.
_SECRET = re.compile("AWS_|AZURE_|GOOGLE_|PGPASS")


class ProcessLostError(Exception):
    """The child died with a request in it; the message says how: `SIGABRT`, `exit status 3`, `deadline of 60 s`."""

    @property
    def cause(self) -> str:
        """The same in one of few words, for counting."""
        return re.sub(r" status \d+| of .*", "", str(self))


class DeadlineError(ProcessLostError):
    """The child did not answer in time and was killed."""


@dataclass(frozen=True)
class Reply:
    """A child's answer. The blobs are the receiver's to close."""

    message: Message
    blobs: list[Blob]


class Process:
    """A running child that speaks `worker.serve`'s protocol; start and use it from one thread only.

    The child leads a session of its own: an interrupt typed at a terminal does not reach it, and whatever it
    starts itself (a linker, for one) is killed with it. Its standard output goes to standard error, because
    the parent's standard output may be an image.
    """

    def __init__(self, command: Sequence[str]) -> None:
        """Run `command` with the descriptor of the child's socket appended; OSError if there is no such program."""
        ours, theirs = socket.socketpair()
        with ExitStack() as on_error, theirs:
            on_error.enter_context(ours)
            self._popen = subprocess.Popen(
                [*command, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=_STDERR,
                env={name: value for name, value in os.environ.items() if not _SECRET.match(name)},
                start_new_session=True,
            )
            on_error.pop_all()
        self._channel = Channel(ours)
        self._grace_s = GRACE_S
        self.hello: Message | None = None

    def greet(self, configuration: Message) -> None:
        """Send the configuration.

        Raises:
            ProcessLostError: the child died already.
        """
        try:
            self._channel.send(configuration)
        except OSError:
            raise ProcessLostError(self.end()) from None

    def has_spoken(self) -> bool:
        """Whether the child has sent something, or ended."""
        return self._channel.readable()

    def await_ready(self, deadline_s: float) -> None:
        """Wait until a child that was greeted is ready; `hello` is then what it says about itself.

        Raises:
            ReportedError: the child says why it cannot work.
            ProcessLostError: it died or took too long.
        """
        self.hello = self._reply(deadline_s).message["ready"]

    @property
    def pid(self) -> int:
        """The child's process id."""
        return self._popen.pid

    def alive(self) -> bool:
        """Whether the child has not ended."""
        return self._popen.poll() is None

    def exchange(self, message: Message, blobs: Sequence[Blob], deadline_s: float) -> Reply:
        """Send a request and wait for its reply; after any error but ReportedError the process is dead.

        Raises:
            ReportedError: the child reports an error and goes on living.
            DeadlineError: no reply within `deadline_s`.
            ProcessLostError: the child died.
        """
        try:
            self._channel.send(message, blobs)
        except OSError:
            raise ProcessLostError(self.end()) from None
        return self._reply(deadline_s)

    def _reply(self, deadline_s: float) -> Reply:
        try:
            reply, results = self._channel.receive(deadline_s)
        except TimeoutError:
            self.end(grace_s=0)
            raise DeadlineError(f"deadline of {deadline_s:g} s") from None
        except (EOFError, OSError):
            raise ProcessLostError(self.end()) from None
        if "failed" in reply:
            raise ReportedError.from_report(reply["failed"])
        return Reply(reply, results)

    def interrupt(self, grace_s: float = GRACE_S) -> None:
        """Make a thread that waits in `exchange` see the end of the stream, and `end` the child with this grace."""
        self._grace_s = grace_s
        self._channel.shutdown()

    def end(self, grace_s: float | None = None) -> str:
        """Wait for the child to go, kill it if it will not within `grace_s`; how it ended, as in `SIGABRT`."""
        self._channel.shutdown()
        try:
            status = self._popen.wait(self._grace_s if grace_s is None else grace_s)
        except subprocess.TimeoutExpired:
            self._kill_session()
            status = self._popen.wait()
        self._channel.close()
        return signal.Signals(-status).name if status < 0 else f"exit status {status}"

    def _kill_session(self) -> None:
        with suppress(ProcessLookupError):  # it ended between the wait and here
            os.killpg(self._popen.pid, signal.SIGKILL)
