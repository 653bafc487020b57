"""Keeps one child process alive and gives it one request at a time.

A request whose child dies or passes the deadline is tried once more on a fresh child, then fails; the next request
finds a working child. A request that nobody waits for any more still has `PATIENCE_S`, then its child is killed.
One thread owns the child for as long as the child lives (see `worker._die_with_parent`).
"""

import asyncio
import logging
import queue
import threading
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.errors import (
    QueueFullError,
    RenderCrashedError,
    RenderTimeoutError,
    ReportedError,
    ServiceError,
    StoppingError,
    UnavailableError,
)
from conicoid_service.process import DeadlineError, Process, ProcessLostError, Reply
from conicoid_service.telemetry import context

ATTEMPTS = 2
PATIENCE_S = 0.5
IDLE_CHECK_S = 1.0
RESTART_DELAYS_S = (1, 2, 5, 10, 30, 60)

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Answer(Reply):
    """A reply, and how long its request waited for the child, milliseconds."""

    queue_ms: float


@dataclass(frozen=True)
class _Task:
    """A request; without a message it only waits until the child has started."""

    message: Message | None
    blobs: Sequence[Blob] = ()
    future: "Future[Answer]" = field(default_factory=Future)
    queued_at: float = field(default_factory=time.perf_counter)
    given_up: threading.Event = field(default_factory=threading.Event)


class Supervisor:
    """One child process and the queue in front of it.

    Attributes:
        losses: how many children died with a request in them, by cause.
        retries: how many requests were tried once more.
    """

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        configuration: Message,
        *,
        queue_length: int,
        deadline_s: float,
        start_deadline_s: float,
    ) -> None:
        """Describe the child; `start` runs it.

        Args:
            name: what the child is called in messages, as in `the render process`.
            command: program and arguments; the descriptor of the child's socket is appended.
            configuration: the first message that each child gets, with `after`, the way its predecessor ended.
            queue_length: how many requests may wait, besides the one in the child.
            deadline_s: time for one request, each time that it is tried.
            start_deadline_s: time until a child is ready.
        """
        self.name = name
        self._command = tuple(command)
        self._configuration = configuration
        self._queue_length = queue_length
        self._deadline_s, self._start_deadline_s = deadline_s, start_deadline_s
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._places = threading.Semaphore(queue_length + 1)
        self._thread = threading.Thread(target=self._run, name=f"{name}-supervisor", daemon=True)
        self._stopping = threading.Event()
        self._process: Process | None = None
        self._exchange = threading.Lock()
        self._in_child: _Task | None = None
        self._after: str | None = None
        self._failure: ServiceError | None = None
        self._failed_starts = 0
        self._next_start = 0.0
        self._hello: Message | None = None
        self.losses: Counter[str] = Counter()
        self.retries = 0

    def start(self) -> None:
        """Start the child in the background; requests may be made at once and wait for it. Once is enough."""
        if self._thread.ident is None:
            self._thread.start()

    def stop(self) -> None:
        """End the child and fail what still waits; returns when both are done."""
        self._stopping.set()
        self._tasks.put(None)
        if process := self._process:
            process.interrupt()
        self._thread.join()

    @property
    def ready(self) -> bool:
        """Whether the child is alive and has finished its start."""
        process = self._process
        return process is not None and process.hello is not None and process.alive()

    @property
    def failure(self) -> ServiceError | None:
        """Why the last start failed, if it did."""
        return self._failure

    @property
    def waiting(self) -> int:
        """How many requests wait."""
        return self._tasks.qsize()

    @property
    def room(self) -> bool:
        """Whether one more request would be taken."""
        return self.waiting <= self._queue_length

    async def hello(self) -> Message:
        """What the child says about itself, once it has started.

        Raises:
            ServiceError: it cannot be started.
        """
        if self._hello is None:
            self._hello = (await self._enqueue(_Task(None))).message
        return self._hello

    async def call(self, message: Message, blobs: Sequence[Blob] = ()) -> Answer:
        """Have the child answer a request.

        If the caller is cancelled, a request that still waits is dropped; one that runs still has `PATIENCE_S`.

        The blobs are taken over: they are closed when the request is done, however it ends.

        Raises:
            QueueFullError: too many requests wait.
            ReportedError: the child refuses the request, or cannot work at all, and says why.
            RenderCrashedError, RenderTimeoutError: the request cost two children their lives.
            UnavailableError: no child can be started.
            StoppingError: the service is shutting down.
        """
        return await self._enqueue(_Task(message, blobs))

    async def _enqueue(self, task: _Task) -> Answer:
        task.future.add_done_callback(lambda _: _close(task.blobs))
        try:
            if self._stopping.is_set():
                raise _stopping()
            if not self._places.acquire(blocking=False):
                raise QueueFullError(
                    f"{self._queue_length} requests wait for the {self.name} process already; try again in a moment"
                )
        except ServiceError:
            task.future.cancel()
            raise
        task.future.add_done_callback(lambda _: self._places.release())
        self._tasks.put(task)
        try:
            return await asyncio.wrap_future(task.future)
        except asyncio.CancelledError:
            task.future.add_done_callback(_discard)
            asyncio.get_running_loop().call_later(PATIENCE_S, self._give_up, task)
            raise

    def _give_up(self, task: _Task) -> None:
        """Nobody waits for the task: should it still be in the child, it ends with the child."""
        task.given_up.set()
        with self._exchange:
            if self._in_child is task and self._process:
                self._process.interrupt(grace_s=0)

    def _run(self) -> None:
        while not self._stopping.is_set():
            self._keep_process()
            try:
                task = self._tasks.get(timeout=IDLE_CHECK_S)
            except queue.Empty:
                continue
            if task is not None and task.future.set_running_or_notify_cancel():
                self._answer(task)
        if self._process:
            self._process.end()
        while not self._tasks.empty():
            if (task := self._tasks.get()) and task.future.set_running_or_notify_cancel():
                task.future.set_exception(_stopping())

    def _answer(self, task: _Task) -> None:
        context.adopt(task.message or {})
        waited_ms = (time.perf_counter() - task.queued_at) * 1e3
        try:
            reply = self._attempt(task)
        except ServiceError as error:
            task.future.set_exception(error)
        except Exception as error:  # a defect here must not end the thread that the service depends on
            logger.exception("the %s supervisor failed", self.name)
            task.future.set_exception(error)
        else:
            task.future.set_result(Answer(reply.message, reply.blobs, waited_ms))

    def _attempt(self, task: _Task) -> Reply:
        for attempt in range(1, ATTEMPTS + 1):
            process = self._keep_process()
            if process is None:
                raise self._failure or _stopping()
            if task.message is None:
                return Reply(process.hello or {}, [])
            try:
                return self._exchange_with(process, task.message, task)
            except ProcessLostError as error:
                lost = error
                if task.given_up.is_set():
                    raise _given_up() from None
                if self._stopping.is_set():
                    raise _stopping() from None
                self.losses[error.cause] += 1
                self.retries += attempt < ATTEMPTS
                logger.warning("the %s process ended (%s) in attempt %d of a request", self.name, lost, attempt)
        if isinstance(lost, DeadlineError):
            raise RenderTimeoutError(
                f"the request passed the {lost} in the {self.name} process, {ATTEMPTS} times; "
                "ask for less work or raise the deadline in the settings"
            )
        raise RenderCrashedError(
            f"the {self.name} process ended ({lost}) with this request in it, {ATTEMPTS} times; "
            "other requests are not affected; report the scene as a defect"
        )

    def _exchange_with(self, process: Process, message: Message, task: _Task) -> Reply:
        with self._exchange:
            if task.given_up.is_set():
                raise _given_up()
            self._in_child = task
        try:
            return process.exchange(message, task.blobs, self._deadline_s)
        finally:
            with self._exchange:
                self._in_child = None

    def _keep_process(self) -> Process | None:
        """The living child, started if need be; None, with `_failure` set, while it cannot be started."""
        if self._process and self._process.alive():
            return self._process
        self._bury()
        if time.monotonic() < self._next_start or self._stopping.is_set():
            return None
        try:
            self._start_process()
        except (ReportedError, ProcessLostError, OSError) as error:
            self._bury()
            self._failed_to_start(error)
        else:
            self._failure, self._failed_starts = None, 0
        return self._process

    def _start_process(self) -> None:
        """Start a child; one that crashes at its start, as compilers in drivers do, is followed by a second."""
        for attempt in range(1, ATTEMPTS + 1):
            self._process = Process(self._command)
            if self._stopping.is_set():  # `stop` interrupts a process that it can see
                raise ProcessLostError("stopping")
            try:
                self._process.greet(self._configuration | {"after": self._after}, self._start_deadline_s)
            except ProcessLostError as error:
                if attempt == ATTEMPTS or isinstance(error, DeadlineError) or self._stopping.is_set():
                    raise
                logger.warning("the %s process ended at its start (%s), starting another", self.name, error)
                self._bury()
            else:
                return

    def _bury(self) -> None:
        if self._process:
            self._after = self._process.end()
            self._process = None

    def _failed_to_start(self, error: Exception) -> None:
        delay_s = RESTART_DELAYS_S[min(self._failed_starts, len(RESTART_DELAYS_S) - 1)]
        self._failed_starts += 1
        self._next_start = time.monotonic() + delay_s
        if isinstance(error, ReportedError):
            self._failure = error
        else:
            self._failure = UnavailableError(
                f"the {self.name} process cannot be started ({error}); the server's log may say why; try again later"
            )
        if not self._stopping.is_set():
            logger.error("the %s process did not start, next try in %d s: %s", self.name, delay_s, error)


def _given_up() -> ServiceError:
    return ServiceError("nobody waits for this request any more")


def _stopping() -> StoppingError:
    return StoppingError("the service is shutting down; try again later or elsewhere")


def _close(blobs: Sequence[Blob]) -> None:
    for blob in blobs:
        blob.close()


def _discard(future: "Future[Answer]") -> None:
    """Close the results that nobody waits for any more."""
    if not future.cancelled() and future.exception() is None:
        _close(future.result().blobs)
