"""uvicorn's HTTP/1.1 connection, with what it lacks against slow, endless and too many clients.

uvicorn times nothing but idle connections, and bounds neither heads nor trailers. Everything here is a bound on time,
bytes or number; its own refusals are problem documents too.
"""

import logging
from asyncio import BaseTransport, CancelledError, Transport
from collections.abc import Callable
from functools import partial
from http import HTTPStatus
from typing import Any, Final, cast

from starlette.responses import Response
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol, RequestResponseCycle

from conicoid_service.errors import ConnectionLimitError, HeadLimitError, HeadTimeoutError
from conicoid_service.guard import HEADERS, Guard
from conicoid_service.problems import http_problem, problem
from conicoid_service.settings import Settings

logger = logging.getLogger(__name__)

HEAD_LIMIT: Final = 1 << 16  # bytes of a request's head, and of anything else between two pieces of a body


class Connection(HttpToolsProtocol):
    """One client's connection."""

    def __init__(self, settings: Settings, **uvicorn: Any) -> None:
        """A connection for the server that passes the arguments `uvicorn`."""
        super().__init__(**uvicorn)
        self.app = partial(_answer, self.app)
        self._settings = settings
        self._in_head, self._in_body = True, False
        self._fruitless = 0  # bytes since a head, a piece of a body or a body was complete
        self._slow_head = _Timer(self, settings.head_timeout_s, self._head_is_late)
        self._unread_body = _Timer(self, settings.body_timeout_s, self._close)
        self._unread_answer = _Timer(self, settings.send_timeout_s, self._abort_if_unread)

    def connection_made(self, transport: BaseTransport) -> None:
        """Count the connection, and wait for its first head."""
        super().connection_made(cast(Transport, transport))
        if len(self.connections) > self._settings.connection_limit:
            most = self._settings.connection_limit
            self._refuse(problem(ConnectionLimitError(f"{most} connections are open, no more may be; try again")))
        else:
            self._slow_head.start()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        for timer in (self._slow_head, self._unread_body, self._unread_answer):
            timer.stop()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Parse what came, and bound what it does not complete."""
        if self.transport.is_closing():
            return
        self._fruitless += len(data)
        super().data_received(data)
        if self.transport.is_closing():
            return
        if self._fruitless > HEAD_LIMIT:
            self._refuse(_too_long("head" if self._in_head else "trailer"))
        elif self._in_head and self._fruitless:
            self._slow_head.start()

    def on_message_begin(self) -> None:
        """A head begins, perhaps behind the body of another request in the same bytes."""
        super().on_message_begin()
        self._fruitless = max(1, self._fruitless)

    def on_headers_complete(self) -> None:
        """A head is complete."""
        self._slow_head.stop()
        self._in_head, self._in_body = False, True
        self._fruitless = 0
        if len(self.url) + sum(len(name) + len(value) for name, value in self.headers) > HEAD_LIMIT:
            self.app = Guard(_too_long("head"))
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """A piece of a body came."""
        self._fruitless = 0
        super().on_body(body)

    def on_message_complete(self) -> None:
        """A request is complete; another may follow."""
        self._in_head, self._in_body = True, False
        self._fruitless = 0
        self._unread_body.stop()
        super().on_message_complete()

    def on_response_complete(self) -> None:
        """An answer is sent. What is left of a body that it did not wait for is dropped, but not for ever."""
        super().on_response_complete()
        self._await_reader()
        if self._in_body and not self._answering():
            self._unread_body.start()

    def pause_writing(self) -> None:
        """The client takes less than it is sent."""
        super().pause_writing()
        self._unread_answer.start()

    def resume_writing(self) -> None:
        """The client takes more again."""
        super().resume_writing()
        self._unread_answer.stop()

    def send_400_response(self, msg: str) -> None:
        """Answer what is not HTTP."""
        self._refuse(http_problem(400, f"{msg.rstrip('.').lower()}; see RFC 9112"))

    def _head_is_late(self) -> None:
        if self._answering():
            self._slow_head.start()
        elif self._fruitless:
            seconds = self._settings.head_timeout_s
            self._refuse(problem(HeadTimeoutError(f"the request's head took over {seconds:g} s; send it faster")))
        else:
            self._close()

    def _refuse(self, response: Response) -> None:
        """Answer in place of the application and close; only close where an answer is under way."""
        if not (self._answering() and self.cycle.response_started):
            self.transport.write(_on_the_wire(response))
        self._close()

    def _answering(self) -> bool:
        cycle: RequestResponseCycle | None = self.cycle  # uvicorn's own type leaves out that there is none at first
        return cycle is not None and not cycle.response_complete

    def _close(self) -> None:
        self.transport.close()
        self._await_reader()

    def _await_reader(self) -> None:
        if self.transport.get_write_buffer_size():
            self._unread_answer.start()

    def _abort_if_unread(self) -> None:
        if self.transport.get_write_buffer_size():
            self.transport.abort()


async def _answer(app: Any, scope: Any, receive: Any, send: Any) -> None:
    """Have the application answer. The server cancels that when a stop has taken long enough, which is no defect."""
    try:
        await app(scope, receive, send)
    except CancelledError:
        logger.info("a request was cut off by the end of the service")


class _Timer:
    """Calls something some seconds after it was started, unless it is stopped before. It runs once at a time."""

    def __init__(self, connection: Connection, seconds: float, then: Callable[[], None]) -> None:
        self._loop, self._seconds, self._then = connection.loop, seconds, then
        self._handle: Any = None

    def start(self) -> None:
        if self._handle is None:
            self._handle = self._loop.call_later(self._seconds, self._fire)

    def stop(self) -> None:
        if self._handle is not None:
            self._handle.cancel()
            self._handle = None

    def _fire(self) -> None:
        self._handle = None
        self._then()


def _too_long(what: str) -> Response:
    return problem(HeadLimitError(f"the request's {what} has over {HEAD_LIMIT} bytes; send less"))


def _on_the_wire(response: Response) -> bytes:
    status = HTTPStatus(response.status_code)
    headers = {**{name.lower(): value for name, value in HEADERS.items()}, **response.headers, "connection": "close"}
    lines = [f"HTTP/1.1 {status} {status.phrase}", *(f"{name}: {value}" for name, value in headers.items()), "", ""]
    return "\r\n".join(lines).encode("latin-1") + bytes(response.body)
