"""The one child of a supervisor: started, started again, and replaced before it is too old."""

import logging
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from conicoid_service.channel import Message
from conicoid_service.errors import ReportedError, ServiceError, UnavailableError
from conicoid_service.process import DeadlineError, Process, ProcessLostError

STARTS = 2
SPEECH_S = 1.0  # in which a child that has begun to say that it is ready must have said it
RESTART_DELAYS_S = (1, 2, 5, 10, 30, 60)

Cause = Literal["crash", "deadline", "cancelled", "recycled"]

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Kind:
    """What a pool's children have in common.

    Attributes:
        name: what the child is called in messages, as in `the render process`.
        command: program and arguments; the descriptor of the child's socket is appended.
        configuration: the first message that each child gets, with `after`, the way its predecessor ended.
        deadline_s: time for one request, each time that it is tried.
        start_deadline_s: time until a child is ready.
        recycle_after: requests after which a child is replaced; 0 means never.
    """

    name: str
    command: Sequence[str]
    configuration: Message
    deadline_s: float
    start_deadline_s: float
    recycle_after: int = 0


class Child:
    """For one thread, apart from what the supervisor's properties and `interrupt_start` look at."""

    def __init__(self, kind: Kind, stopping: threading.Event) -> None:
        """Nothing is started before `keep`, and nothing any more once `stopping` is set."""
        self._kind, self._stopping = kind, stopping
        self.process: Process | None = None
        self.failure: ServiceError | None = None
        self.ended: Counter[Cause] = Counter()
        self._successor: Process | None = None
        self._successor_by = 0.0
        self._served = 0
        self._after: str | None = None
        self._failed_starts = 0
        self._next_start = 0.0

    def keep(self) -> Process | None:
        """The living child, started if need be; None, with `failure` set, while it cannot be started."""
        if self.process and self.process.alive():
            return self.process
        self.bury("crash")
        if time.monotonic() < self._next_start or self._stopping.is_set():
            return None
        try:
            self._start()
        except (ReportedError, ProcessLostError, OSError) as error:
            self.bury("deadline" if isinstance(error, DeadlineError) else "crash")
            self._failed_to_start(error)
        else:
            self.failure, self._failed_starts, self._served = None, 0, 0
        return self.process

    def bury(self, cause: Cause) -> None:
        """The child, if there is one, is dead or as good as dead."""
        if self.process:
            self._after = self.process.end()
            self.process = None
            self.ended[cause] += 1

    def served(self) -> None:
        """The child has ended a request."""
        self._served += 1

    def renew(self) -> None:
        """Between two requests: start the successor of a child that is old enough, let it follow once it is ready."""
        if self._successor is None:
            if self.process and 0 < self._kind.recycle_after <= self._served:
                self._served = 0  # should the successor fail, the next try is as many requests away
                self._successor = self._begin_successor()
                self._successor_by = time.monotonic() + self._kind.start_deadline_s
        elif self._successor.has_spoken() or time.monotonic() > self._successor_by:
            successor, self._successor = self._successor, None
            try:
                successor.await_ready(SPEECH_S)
            except (ReportedError, ProcessLostError) as error:
                successor.end(grace_s=0)
                logger.warning("the %s process keeps running: its successor did not start (%s)", self._kind.name, error)
                return
            if self.process:
                self.process.end()
                self.ended["recycled"] += 1
            self.process, self._served = successor, 0

    def end(self) -> None:
        """End the child and its successor."""
        if self.process:
            self.process.end()
        if self._successor:
            self._successor.end(grace_s=0)

    def interrupt_start(self) -> None:
        """From another thread: let a child that is still starting go."""
        process = self.process
        if process and process.hello is None:
            process.interrupt(grace_s=0)

    def _start(self) -> None:
        """Start a child; one that crashes at its start, as compilers in drivers do, is followed by a second."""
        for attempt in range(1, STARTS + 1):
            self.process = Process(self._kind.command)
            if self._stopping.is_set():  # `interrupt_start` reaches a process that it can see
                raise ProcessLostError("stopping")
            try:
                self.process.greet(self._kind.configuration | {"after": self._after})
                self.process.await_ready(self._kind.start_deadline_s)
            except ProcessLostError as error:
                if attempt == STARTS or isinstance(error, DeadlineError) or self._stopping.is_set():
                    raise
                logger.warning("the %s process ended at its start (%s), starting another", self._kind.name, error)
                self.bury("crash")
            else:
                return

    def _begin_successor(self) -> Process | None:
        try:
            successor = Process(self._kind.command)
        except OSError as error:
            logger.warning("the %s process keeps running: no successor can be started (%s)", self._kind.name, error)
            return None
        try:
            successor.greet(self._kind.configuration | {"after": None})
        except ProcessLostError as error:
            logger.warning("the %s process keeps running: its successor ended (%s)", self._kind.name, error)
            return None
        return successor

    def _failed_to_start(self, error: Exception) -> None:
        delay_s = RESTART_DELAYS_S[min(self._failed_starts, len(RESTART_DELAYS_S) - 1)]
        self._failed_starts += 1
        self._next_start = time.monotonic() + delay_s
        if isinstance(error, ReportedError):
            self.failure = error
        else:
            self.failure = UnavailableError(
                f"the {self._kind.name} process cannot be started ({error}); "
                "the server's log may say why; try again later"
            )
        if not self._stopping.is_set():
            logger.error("the %s process did not start, next try in %d s: %s", self._kind.name, delay_s, error)
