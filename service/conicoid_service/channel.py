"""Messages between the API process and a child: a small JSON object and any number of blobs.

Only JSON is read on the API's side, so a child that hostile input has taken over cannot make the API run anything.
"""

import select
import socket
import struct
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import orjson

from conicoid_service.blob import Blob

Message = dict[str, Any]

MAX_BLOBS = 253  # in one message, which Linux allows
_LENGTH = struct.Struct("!I")


class Channel:
    """One end of a connected stream socket; not thread-safe."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection

    def send(self, message: Message, blobs: Sequence[Blob] = ()) -> None:
        """Send one message; the receiver gets its own descriptors of the blobs.

        Raises:
            OSError: the other end is gone.
        """
        payload = orjson.dumps(message)
        self._limit(None)
        socket.send_fds(self._socket, [_LENGTH.pack(len(payload))], [blob.fileno() for blob in blobs])
        self._socket.sendall(payload)

    def receive(self, timeout_s: float | None = None) -> tuple[Message, list[Blob]]:
        """The next message; the caller closes its blobs.

        Raises:
            EOFError: the other end is gone.
            TimeoutError: nothing whole has come within `timeout_s`.
        """
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        self._limit(deadline)
        try:
            length, descriptors, _, _ = socket.recv_fds(self._socket, _LENGTH.size, MAX_BLOBS)
            blobs = [Blob(descriptor) for descriptor in descriptors]
            try:
                length += self._exactly(_LENGTH.size - len(length), deadline)
                message = orjson.loads(self._exactly(_LENGTH.unpack(length)[0], deadline))
            except BaseException:
                for blob in blobs:
                    blob.close()
                raise
        except ConnectionError as error:
            raise EOFError("the other end is gone") from error
        return message, blobs

    def readable(self) -> bool:
        """Whether `receive` would find something, or the end, at once."""
        poll = select.poll()
        poll.register(self._socket, select.POLLIN)
        return bool(poll.poll(0))

    def shutdown(self) -> None:
        """Make both ends see the end of the stream, also one that waits in another thread."""
        with suppress(OSError):  # the other end was first, or this end is closed
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Give this end up."""
        self._socket.close()

    def _exactly(self, size: int, deadline: float | None) -> bytes:
        received = bytearray()
        while len(received) < size:
            self._limit(deadline)
            part = self._socket.recv(size - len(received))
            if not part:
                raise EOFError("the other end is gone")
            received += part
        return bytes(received)

    def _limit(self, deadline: float | None) -> None:
        # A timeout of 0 would make the socket non-blocking.
        self._socket.settimeout(None if deadline is None else max(deadline - time.monotonic(), 1e-3))
