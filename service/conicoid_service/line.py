"""The line in front of a pool of child processes: who waits, who is next, and who is sent away."""

import math
import threading
import time
from collections import OrderedDict, deque
from dataclasses import dataclass

from conicoid_service.errors import QueueFullError
from conicoid_service.task import Task, stopping

LAST = 32  # durations that the mean is taken of
LEAST_RETRY_S, MOST_RETRY_S = 1, 60


@dataclass(frozen=True)
class Waiting:
    """What a line holds at a moment: requests by class, the age of the oldest of each in seconds, those sent away."""

    interactive: int
    batch: int
    interactive_age_s: float
    batch_age_s: float
    refusals: int


class Line:
    """Thread-safe. Interactive requests go before those of batches; in each class the owners take turns."""

    def __init__(self, name: str, *, queue_length: int, owner_queue_length: int, processes: int) -> None:
        """An empty line.

        Args:
            name: what the processes are called in messages.
            queue_length: how many interactive requests may wait, besides those that idle processes are about to take.
            owner_queue_length: how many of them may be of one owner, unless it is "".
            processes: how many take from the line.
        """
        self._name, self._processes = name, processes
        self._queue_length, self._owner_queue_length = queue_length, owner_queue_length
        self._classes = {False: _Turns(), True: _Turns()}  # by `Task.batch`, in the order in which they are served
        self._changed = threading.Condition()
        self._in_children = 0
        self._last: deque[float] = deque(maxlen=LAST)
        self._refusals = 0
        self._closed = False

    def put(self, task: Task) -> None:
        """Let a request wait; should it be cancelled, it leaves the line.

        Raises:
            QueueFullError: too many wait.
            StoppingError: the line is closed.
        """
        with self._changed:
            if self._closed:
                raise stopping()
            if not task.batch:
                self._check_room(task.owner)
            self._classes[task.batch].add(task)
            self._changed.notify()
        task.future.add_done_callback(lambda _: self._leave(task))

    def get(self, timeout_s: float) -> Task | None:
        """The next request, which `done` has to be told about; None if none comes in time or the line is closed."""
        deadline = time.monotonic() + timeout_s
        with self._changed:
            while True:
                for turns in self._classes.values():
                    while (task := turns.take()) is not None:
                        if task.future.set_running_or_notify_cancel():
                            self._in_children += 1
                            return task
                left_s = deadline - time.monotonic()
                if self._closed or left_s <= 0:
                    return None
                self._changed.wait(left_s)

    def done(self, task: Task, seconds: float) -> None:
        """A request that `get` gave has ended, after so many seconds."""
        with self._changed:
            self._in_children -= 1
            if task.message is not None:
                self._last.append(seconds)

    def close(self) -> list[Task]:
        """Let nobody in any more; those who waited."""
        with self._changed:
            self._closed = True
            waited = [task for turns in self._classes.values() for task in turns.clear()]
            self._changed.notify_all()
        return waited

    def room(self) -> bool:
        """Whether one more interactive request may wait."""
        with self._changed:
            return len(self._classes[False]) < self._queue_length + self._idle()

    def waiting(self) -> Waiting:
        """What waits now."""
        with self._changed:
            interactive, batch = (self._classes[kind] for kind in (False, True))
            return Waiting(len(interactive), len(batch), interactive.age_s(), batch.age_s(), self._refusals)

    def _check_room(self, owner: str) -> None:
        turns = self._classes[False]
        idle = self._idle()
        if len(turns) >= self._queue_length + idle:
            whose = f"{self._queue_length} requests wait"
        elif owner and turns.count(owner) >= self._owner_queue_length + idle:
            whose = f"{self._owner_queue_length} requests of this API key wait"
        else:
            return
        self._refusals += 1
        error = QueueFullError(f"{whose} for the {self._name} process already; try again in a moment")
        error.retry_after_s = self._retry_after_s(len(turns))
        raise error

    def _idle(self) -> int:
        return max(0, self._processes - self._in_children)

    def _retry_after_s(self, waiting: int) -> int:
        """When those who wait now should have been served, seconds."""
        mean_s = sum(self._last) / len(self._last) if self._last else 0.0
        return min(MOST_RETRY_S, max(LEAST_RETRY_S, math.ceil(waiting * mean_s / self._processes)))

    def _leave(self, task: Task) -> None:
        with self._changed:
            self._classes[task.batch].remove(task)


class _Turns:
    """Requests of one class; the owner who has waited longest since its last turn is next. Not thread-safe."""

    def __init__(self) -> None:
        self._owners: OrderedDict[str, OrderedDict[Task, None]] = OrderedDict()

    def add(self, task: Task) -> None:
        self._owners.setdefault(task.owner, OrderedDict())[task] = None

    def take(self) -> Task | None:
        if not self._owners:
            return None
        owner = next(iter(self._owners))
        task = next(iter(self._owners[owner]))
        self._owners.move_to_end(owner)
        self.remove(task)
        return task

    def remove(self, task: Task) -> None:
        """Take a task out, if it is in."""
        own = self._owners.get(task.owner)
        if own is not None:
            own.pop(task, None)
            if not own:
                del self._owners[task.owner]

    def clear(self) -> list[Task]:
        tasks = [task for own in self._owners.values() for task in own]
        self._owners.clear()
        return tasks

    def count(self, owner: str) -> int:
        return len(self._owners.get(owner, ()))

    def age_s(self) -> float:
        """How long the oldest waits, 0 if there is none: in each owner's queue it is the first."""
        now = time.perf_counter()
        return max((now - next(iter(own)).queued_at for own in self._owners.values()), default=0.0)

    def __len__(self) -> int:
        return sum(map(len, self._owners.values()))
