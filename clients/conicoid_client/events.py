"""Server-sent events (WHATWG HTML, 9.2), read strictly, of a job, through however many connections."""

import json
import re
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import httpx

from conicoid_client.connection import Connection, pause_lengths
from conicoid_client.errors import ClientError, ProblemError, ServerBusy, Unreachable
from conicoid_client.jobs import Event, FrameEnded, Job, JobEnded, Progress

# The service says something every 15 s.
_SILENCE_S = 45.0
# A job, a frame and the reason why it failed take less than a thousandth of this.
_LARGEST_EVENT = 1 << 20
# A carriage return at the end may be the first half of a line's end.
_LINE_END = re.compile(rb"\r\n|\n|\r(?=[^\n])")
_GATEWAY_ERRORS = frozenset({502, 504})
END = "end"


@dataclass(frozen=True)
class Message:
    """One event as it was sent; `id` is None where it has none."""

    event: str
    data: str
    id: str | None


def messages(chunks: Iterable[bytes]) -> Iterator[Message]:
    """The events of a stream; one that the stream's end cuts is none.

    Raises:
        ClientError: it is not UTF-8, or an event is larger than a MiB.
    """
    event, event_id, data, size = "", None, list[str](), 0
    for line in _lines(chunks):
        if not line:
            if data:
                yield Message(event or "message", "\n".join(data), event_id)
            event, event_id, data, size = "", None, [], 0
            continue
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        if name == "data":
            data.append(value)
            size += len(value) + 1
            if size > _LARGEST_EVENT:
                raise ClientError("the service sent an event that is larger than a MiB")
        elif name == "event":
            event = value
        elif name == "id" and "\0" not in value:
            event_id = value


def _lines(chunks: Iterable[bytes]) -> Iterator[str]:
    rest, first = b"", True
    for chunk in chunks:
        *lines, rest = _LINE_END.split(rest + chunk)
        if len(rest) > _LARGEST_EVENT:
            raise ClientError("the service sent an event that is larger than a MiB")
        for line in lines:
            try:
                text = line.decode()
            except UnicodeDecodeError:
                raise ClientError("the service sent events that are not UTF-8") from None
            yield text.removeprefix("\ufeff") if first else text
            first = False
    if rest.endswith(b"\r"):
        yield rest[:-1].decode(errors="replace")


def follow(connection: Connection, path: str, last_event_id: str | None, patience_s: float) -> Iterator[Event]:
    """The events of a job until its end, each frame once, taken up again where a connection ends.

    Args:
        connection: to the service.
        path: of the events.
        last_event_id: of the last frame that is known already.
        patience_s: how long a service that does not answer is waited for.
    Raises:
        Unreachable, ServerBusy: the service was away for longer.
        ProblemError: it refuses, as with `unknown-job`.
        ClientError: what it sends are not a job's events.
    """
    stream = _Stream(connection, path, last_event_id)
    waited_s, pauses = 0.0, pause_lengths()
    while True:
        lost: ClientError | None = None
        try:
            for event in stream.once():
                waited_s = 0.0
                if isinstance(event, FrameEnded):
                    pauses = pause_lengths()
                yield event
        except httpx.HTTPError as error:
            lost = Unreachable(f"no answer from {connection.address}: {str(error) or type(error).__name__}")
        except ProblemError as error:
            if not isinstance(error, ServerBusy) and error.status not in _GATEWAY_ERRORS:
                raise
            lost = error
        if stream.ended:
            return
        pause_s = next(pauses)
        if isinstance(lost, ServerBusy):
            pause_s = max(pause_s, lost.retry_after or 0.0)
        waited_s += pause_s
        if lost is not None and waited_s > patience_s:
            raise lost
        time.sleep(pause_s)


class _Stream:
    """What is known of a job's events.

    Attributes:
        ended: the last of them has come.
    """

    def __init__(self, connection: Connection, path: str, last_event_id: str | None) -> None:
        self._connection, self._path = connection, path
        self._known = last_event_id
        self._last = 0 if last_event_id in (None, END) else _number(last_event_id)
        self.ended = False

    def once(self) -> Iterator[Event]:
        """The events that one connection tells of and that were not known."""
        headers = {"Accept": "text/event-stream"} | ({} if self._known is None else {"Last-Event-ID": self._known})
        with self._connection.stream(
            self._path, "text/event-stream", headers=headers, silence_s=_SILENCE_S
        ) as response:
            if response.status_code == httpx.codes.NO_CONTENT:
                self.ended = True
                return
            for message in messages(response.iter_bytes()):
                event = _event(message)
                if event is None:
                    continue
                if isinstance(event, FrameEnded):
                    if (number := _number(event.id)) <= self._last:
                        continue
                    self._last, self._known = number, event.id
                self.ended = isinstance(event, JobEnded)
                yield event
                if self.ended:
                    return


def _event(message: Message) -> Event | None:
    """What an event means; None for a kind that this client does not know.

    Raises:
        ClientError: it is not what its kind says.
    """
    kinds = ("progress", "frame", END)
    if message.event not in kinds:
        return None
    try:
        data = json.loads(message.data)
    except ValueError:
        raise ClientError("the service sent an event that is not JSON") from None
    if message.event == "frame":
        if message.id is None:
            raise ClientError("the service sent a frame's event without an id")
        return FrameEnded.read(message.id, data)
    return (JobEnded if message.event == END else Progress)(Job.read(data))


def _number(event_id: str | None) -> int:
    if event_id is None or not (event_id.isascii() and event_id.isdecimal()):
        raise ClientError(f"{event_id!r} is not the id of a frame's event")
    return int(event_id)
