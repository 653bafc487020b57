"""What is going on in this task or thread: ids for the log, and notes for the one line about a request."""

import time
from collections.abc import Iterable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, Final

request_id: Final[ContextVar[str]] = ContextVar("request_id", default="")
job_id: Final[ContextVar[str]] = ContextVar("job_id", default="")

_IDS: Final = (request_id, job_id)


@dataclass(frozen=True)
class Step:
    """What a child process did for a request: its stages, milliseconds, one after the other.

    Attributes:
        ended_ns: when the answer came, nanoseconds since 1970.
    """

    process: str
    stages: Mapping[str, float]
    ended_ns: int = field(default_factory=time.time_ns)


@dataclass
class Notes:
    """What the layers below learn about a request, for the log line, the metrics and the trace.

    Attributes:
        code: of the problem document, "" without one.
        image: where the image of the answer comes from, "" without one: `gallery.Source`, or `304`.
        steps: what child processes did for it.
    """

    code: str = ""
    image: str = ""
    steps: list[Step] = field(default_factory=list)


def added_up(parts: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Durations by stage, those of the same name in several processes added up."""
    stages: dict[str, float] = {}
    for part in parts:
        for stage, duration in part.items():
            stages[stage] = stages.get(stage, 0.0) + duration
    return stages


_notes: Final[ContextVar[Notes | None]] = ContextVar("notes", default=None)


def take_notes() -> Notes:
    """The notes of the request that begins in this context, and in all tasks that it starts."""
    notes = Notes()
    _notes.set(notes)
    return notes


def notes() -> Notes:
    """The notes of the request in this context; where there is none, notes that nobody reads."""
    return _notes.get() or Notes()


def ids() -> dict[str, str]:
    """The ids of this context that are known, to be sent with a message or added to a log line."""
    return {one.name: value for one in _IDS if (value := one.get())}


def adopt(message: Mapping[str, Any]) -> None:
    """Make the ids that came with a message those of this context; unknown where it has none."""
    for one in _IDS:
        one.set(message.get(one.name, ""))
