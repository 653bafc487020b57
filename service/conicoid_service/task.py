"""A request on its way to a child process, and what becomes of it."""

import threading
import time
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.errors import GivenUpError, StoppingError
from conicoid_service.process import Process, Reply


@dataclass(frozen=True)
class Answer(Reply):
    """A reply, and how long its request waited for the child, milliseconds."""

    queue_ms: float


@dataclass(eq=False)
class Task:
    """A request; without a message it only waits until a child has started.

    Attributes:
        blobs: taken over: closed when the request is done, however it ends.
        owner: whose it is, "" where there are no owners.
        batch: whether it may wait for those of people who look at the answer.
        queued_at: by `time.perf_counter`.
    """

    message: Message | None
    blobs: Sequence[Blob] = ()
    owner: str = ""
    batch: bool = False
    future: "Future[Answer]" = field(default_factory=Future)
    queued_at: float = field(default_factory=time.perf_counter)

    def __post_init__(self) -> None:
        self.future.add_done_callback(lambda _: _close(self.blobs))
        self._lock = threading.Lock()
        self._process: Process | None = None
        self.given_up = False

    def exchange(self, process: Process, message: Message, deadline_s: float) -> Reply:
        """As `Process.exchange`, which `give_up` may end.

        Raises:
            GivenUpError: it was given up before.
        """
        with self._lock:
            if self.given_up:
                raise GivenUpError("nobody waits for this request any more")
            self._process = process
        try:
            return process.exchange(message, self.blobs, deadline_s)
        finally:
            with self._lock:
                self._process = None

    def give_up(self) -> None:
        """Nobody waits for it: should a child work on it, it ends with the child."""
        with self._lock:
            self.given_up = True
            if self._process:
                self._process.interrupt(grace_s=0)

    def discard(self) -> None:
        """Close the results, should there ever be some: nobody takes them."""
        self.future.add_done_callback(_discard)

    def fail(self, error: Exception) -> None:
        """End it with an error, unless it was cancelled while it waited."""
        if self.future.running() or self.future.set_running_or_notify_cancel():
            self.future.set_exception(error)


def stopping() -> StoppingError:
    """What requests get while the service ends."""
    return StoppingError("the service is shutting down; try again later or elsewhere")


def _close(blobs: Sequence[Blob]) -> None:
    for blob in blobs:
        blob.close()


def _discard(future: "Future[Answer]") -> None:
    if not future.cancelled() and future.exception() is None:
        _close(future.result().blobs)
