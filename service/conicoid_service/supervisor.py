"""Gives one child process one request of the line at a time.

A request whose child dies or passes the deadline is tried once more on a fresh child, then fails; the next request
finds a working child. One thread owns the child for as long as the child lives (see `worker._die_with_parent`).
"""

import logging
import threading
import time
from collections import Counter
from collections.abc import Callable

from conicoid_service.child import Child, Kind
from conicoid_service.errors import GivenUpError, RenderCrashedError, RenderTimeoutError, ServiceError
from conicoid_service.line import Line
from conicoid_service.process import DeadlineError, ProcessLostError, Reply
from conicoid_service.task import Answer, Task, stopping
from conicoid_service.telemetry import context

ATTEMPTS = 2
IDLE_CHECK_S = 1.0

logger = logging.getLogger(__name__)


class Supervisor:
    """One child process and the thread that owns it.

    Attributes:
        losses: how many children died with a request in them, by cause.
        retries: how many requests were tried once more.
    """

    def __init__(self, kind: Kind, line: Line, others_hope: Callable[[], bool]) -> None:
        """Describe the child; `start` runs it.

        Args:
            kind: of the child.
            line: where requests wait.
            others_hope: whether another supervisor of the line has a child, or may soon; if so, one that cannot
                start its own leaves the requests to them instead of failing them.
        """
        self._name, self._deadline_s = kind.name, kind.deadline_s
        self._line, self._others_hope = line, others_hope
        self._stopping = threading.Event()
        self.child = Child(kind, self._stopping)
        self.losses: Counter[str] = Counter()
        self.retries = 0
        self._thread = threading.Thread(target=self._run, name=f"{kind.name}-supervisor", daemon=True)

    def start(self) -> None:
        """Start the child in the background. Once is enough."""
        if self._thread.ident is None:
            self._thread.start()

    def begin_stop(self) -> None:
        """Begin nothing more; a request that runs may come to its end."""
        self._stopping.set()
        self.child.interrupt_start()

    def stop(self, deadline: float) -> None:
        """Return when child and thread have ended; what still runs at `deadline`, by `time.monotonic`, is killed."""
        if self._thread.ident is None:
            return
        self._thread.join(max(0.0, deadline - time.monotonic()))
        if self._thread.is_alive() and (process := self.child.process):
            process.interrupt(grace_s=0)
        self._thread.join()

    @property
    def ready(self) -> bool:
        """Whether the child is alive and has finished its start."""
        process = self.child.process
        return process is not None and process.hello is not None and process.alive()

    def _run(self) -> None:
        while not self._stopping.is_set():
            self.child.renew()
            if self.child.keep() is None and self._others_hope():
                self._stopping.wait(IDLE_CHECK_S)
            elif task := self._line.get(IDLE_CHECK_S):
                self._answer(task)
        self.child.end()

    def _answer(self, task: Task) -> None:
        context.adopt(task.message or {})
        started = time.perf_counter()
        waited_ms = (started - task.queued_at) * 1e3
        try:
            reply = self._attempt(task)
        except Exception as error:  # a defect here must not end the thread that the service depends on
            if not isinstance(error, ServiceError):
                logger.exception("the %s supervisor failed", self._name)
            self._line.done(task, time.perf_counter() - started)
            task.fail(error)
        else:
            self._line.done(task, time.perf_counter() - started)
            task.future.set_result(Answer(reply.message, reply.blobs, waited_ms))

    def _attempt(self, task: Task) -> Reply:
        for attempt in range(1, ATTEMPTS + 1):
            process = self.child.keep()
            if process is None:
                raise self.child.failure or stopping()
            if task.message is None:
                return Reply(process.hello or {}, [])
            self.retries += attempt > 1
            self.child.served()
            try:
                return task.exchange(process, task.message, self._deadline_s)
            except ProcessLostError as error:
                lost = error
                self._lost(task, lost)
                logger.warning("the %s process ended (%s) in attempt %d of a request", self._name, lost, attempt)
        if isinstance(lost, DeadlineError):
            raise RenderTimeoutError(
                f"the request passed the {lost} in the {self._name} process, {ATTEMPTS} times; "
                "ask for less work or raise the deadline in the settings"
            )
        raise RenderCrashedError(
            f"the {self._name} process ended ({lost}) with this request in it, {ATTEMPTS} times; "
            "other requests are not affected; report the scene as a defect"
        )

    def _lost(self, task: Task, lost: ProcessLostError) -> None:
        """Bury the child; a request that nobody waits for, or that a stop ended, is not tried again."""
        if task.given_up:
            self.child.bury("cancelled")
            self.losses["cancelled"] += 1
            raise GivenUpError("nobody waited for this request any more")
        self.child.bury("deadline" if isinstance(lost, DeadlineError) else "crash")
        if self._stopping.is_set():
            raise stopping()
        self.losses[lost.cause] += 1
