"""A TCP proxy that tests put before a server, to let it seem slow, gone or broken to its clients."""

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Event, Lock, Thread
from types import TracebackType
from typing import Self

from tests.farm.processes import server_port

_CHUNK = 1 << 16


class Proxy:
    """Passes bytes between its port and a server's until told otherwise."""

    def __init__(self, port: int, address: str = "127.0.0.1") -> None:
        self.address, self.port = address, server_port(address)
        self._server = (address, port)
        self._moves = Event()
        self._s_per_byte = 0.0
        self._lock = Lock()
        self._sockets: set[socket.socket] = set()
        self._listener: socket.socket | None = None
        self._serve: Callable[[socket.socket], None] = self._join

    def let_through(self) -> None:
        """Pass all bytes, also those that were held back, and take connections again."""
        self._serve = self._join
        self._moves.set()
        if self._listener is None:
            self._listener = socket.create_server((self.address, self.port))
            Thread(target=self._accept, args=(self._listener,), daemon=True).start()

    def stall(self) -> None:
        """Take connections and bytes, and hold the bytes back."""
        self._moves.clear()

    def slow(self, bytes_per_s: float) -> None:
        """Pass so many bytes a second and no more, each connection each way."""
        self._s_per_byte = 1 / bytes_per_s

    def cut(self) -> None:
        """End every connection there is; new ones are passed."""
        with self._lock:
            for one in self._sockets:
                with suppress(OSError):
                    one.shutdown(socket.SHUT_RDWR)

    def refuse(self) -> None:
        """End every connection, and take no new one."""
        if self._listener is not None:
            self._listener.shutdown(socket.SHUT_RDWR)  # which wakes the thread that waits in accept
            self._listener.close()
            self._listener = None
        self.cut()

    def answer(self, status: int) -> None:
        """End every connection, and answer each HTTP request to come with a status and nothing else."""
        self._serve = lambda client: _answer(client, status)
        self.cut()

    def _accept(self, listener: socket.socket) -> None:
        with suppress(OSError):  # closed
            while True:
                client, _ = listener.accept()
                Thread(target=self._held, args=(client,), daemon=True).start()

    def _held(self, client: socket.socket) -> None:
        """Serve a connection, where `cut` finds it."""
        with client, suppress(OSError), self._known(client):
            self._serve(client)

    def _join(self, client: socket.socket) -> None:
        with socket.create_connection(self._server) as server, self._known(server):
            back = Thread(target=self._pump, args=(server, client), daemon=True)
            back.start()
            self._pump(client, server)
            back.join()

    def _pump(self, source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while data := source.recv(_CHUNK):
                self._moves.wait()
                time.sleep(len(data) * self._s_per_byte)
                sink.sendall(data)
        with suppress(OSError):
            sink.shutdown(socket.SHUT_WR)

    @contextmanager
    def _known(self, one: socket.socket) -> Iterator[None]:
        with self._lock:
            self._sockets.add(one)
        try:
            yield
        finally:
            with self._lock:
                self._sockets.discard(one)

    def __enter__(self) -> Self:
        self.let_through()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.refuse()
        self._moves.set()


def _answer(client: socket.socket, status: int) -> None:
    """One HTTP answer, once a request's head is there; its body is read to the end, or the client would miss it."""
    head = b""
    while b"\r\n\r\n" not in head:
        data = client.recv(_CHUNK)
        if not data:
            return
        head += data
    client.sendall(f"HTTP/1.1 {status} Told to\r\nContent-Length: 0\r\nConnection: close\r\n\r\n".encode())
    client.shutdown(socket.SHUT_WR)
    while client.recv(_CHUNK):
        pass
