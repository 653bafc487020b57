"""Child processes of one kind behind one line."""

import asyncio
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.child import Cause, Kind
from conicoid_service.errors import ServiceError
from conicoid_service.line import Line, Waiting
from conicoid_service.supervisor import Supervisor
from conicoid_service.task import Answer, Task, stopping

PATIENCE_S = 0.5
STOP_GRACE_S = 2.0


@dataclass(frozen=True)
class Counts:
    """What telemetry shows of a pool.

    Attributes:
        waiting: what the line holds, and how many it has sent away.
        alive: processes that are ready for work, or work.
        ended: processes that had to be replaced so far, by cause.
        retries: requests that were given to a second process so far.
    """

    waiting: Waiting
    alive: int
    ended: Mapping[Cause, int]
    retries: int


class Pool:
    """Some child processes and the line in front of them."""

    def __init__(self, kind: Kind, *, queue_length: int, owner_queue_length: int, processes: int = 1) -> None:
        """Describe as many children as `processes`, which `start` or the first request runs; the rest as in `Line`."""
        self.name = kind.name
        self._line = Line(
            kind.name, queue_length=queue_length, owner_queue_length=owner_queue_length, processes=processes
        )
        self._supervisors = [Supervisor(kind, self._line, partial(self._hope, number)) for number in range(processes)]
        self._hello: Message | None = None

    def start(self) -> None:
        """Start the children in the background, so that the first request, which would start them, finds them warm."""
        for supervisor in self._supervisors:
            supervisor.start()

    def stop(self) -> None:
        """Fail what waits, let what runs come to its end within `STOP_GRACE_S`, end the children."""
        for task in self._line.close():
            task.fail(stopping())
        for supervisor in self._supervisors:
            supervisor.begin_stop()
        deadline = time.monotonic() + STOP_GRACE_S
        for supervisor in self._supervisors:
            supervisor.stop(deadline)

    @property
    def ready(self) -> bool:
        """Whether a child is alive and has finished its start."""
        return any(supervisor.ready for supervisor in self._supervisors)

    @property
    def failure(self) -> ServiceError | None:
        """Why no child can be started, if so."""
        failures = [supervisor.child.failure for supervisor in self._supervisors]
        return failures[0] if None not in failures else None

    @property
    def waiting(self) -> int:
        """How many requests wait."""
        held = self._line.waiting()
        return held.interactive + held.batch

    @property
    def room(self) -> bool:
        """Whether one more interactive request would be taken."""
        return self._line.room()

    @property
    def losses(self) -> Counter[str]:
        """How many children ended with a request in them so far, by what ended them: `SIGABRT`, `deadline`..."""
        return sum((supervisor.losses.copy() for supervisor in self._supervisors), Counter[str]())

    @property
    def retries(self) -> int:
        """How many requests were tried once more so far."""
        return sum(supervisor.retries for supervisor in self._supervisors)

    def counts(self) -> Counts:
        """How the pool is."""
        ended: Counter[Cause] = Counter()
        for supervisor in self._supervisors:
            ended.update(supervisor.child.ended.copy())
        alive = sum(supervisor.ready for supervisor in self._supervisors)
        return Counts(self._line.waiting(), alive, ended, self.retries)

    async def hello(self) -> Message:
        """What a child says about itself, once one has started.

        Raises:
            ServiceError: none can be started.
        """
        if self._hello is None:
            self._hello = (await self._enqueue(Task(None))).message
        return self._hello

    async def call(
        self, message: Message, blobs: Sequence[Blob] = (), *, owner: str = "", batch: bool = False
    ) -> Answer:
        """Have a child answer a request; one of a `batch` waits for all others, and owners take turns.

        If the caller is cancelled, a request that still waits is dropped; one that runs still has `PATIENCE_S`, then
        its child is killed. The blobs are taken over: they are closed when the request is done, however it ends.

        Raises:
            QueueFullError: too many requests wait.
            ReportedError: the child refuses the request, or cannot work at all, and says why.
            RenderCrashedError, RenderTimeoutError: the request cost two children their lives.
            UnavailableError: no child can be started.
            StoppingError: the service is shutting down.
        """
        return await self._enqueue(Task(message, blobs, owner, batch))

    async def _enqueue(self, task: Task) -> Answer:
        try:
            self._line.put(task)
        except ServiceError:
            task.future.cancel()
            raise
        self.start()
        try:
            return await asyncio.wrap_future(task.future)
        except asyncio.CancelledError:
            task.discard()
            asyncio.get_running_loop().call_later(PATIENCE_S, task.give_up)
            raise

    def _hope(self, number: int) -> bool:
        """Whether another child than this one works, or has not failed to."""
        return any(one.child.failure is None for other, one in enumerate(self._supervisors) if other != number)
