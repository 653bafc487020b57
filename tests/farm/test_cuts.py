"""What stands between servers and their users in the farm's tests: a proxy, and a network with a cable to pull."""

import http.server
import socket
import subprocess
from collections.abc import Iterator
from contextlib import closing
from threading import Thread

import httpx
import pytest

from tests.farm.network import Network
from tests.farm.processes import until
from tests.farm.proxy import Proxy


class Echo(http.server.BaseHTTPRequestHandler):
    """Answers with the request's body."""

    protocol_version = "HTTP/1.1"

    def do_PUT(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002
        pass


def echo(address: str) -> Iterator[int]:
    """The port of a server."""
    with http.server.ThreadingHTTPServer((address, 0), Echo) as server:
        server.daemon_threads = True
        Thread(target=server.serve_forever, daemon=True).start()
        yield server.server_port
        server.shutdown()


@pytest.fixture
def proxy() -> Iterator[Proxy]:
    for port in echo("127.0.0.1"):
        with Proxy(port) as proxy:
            yield proxy


@pytest.fixture
def client(proxy: Proxy) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=f"http://127.0.0.1:{proxy.port}", timeout=0.5) as client:
        yield client


def test_bytes_pass_both_ways(client: httpx.Client) -> None:
    body = bytes(range(256)) * 10_000
    assert client.put("/", content=body).content == body
    assert client.put("/", content=b"again").content == b"again"


def test_stalled_connections_hold_their_bytes_back_and_lose_none(proxy: Proxy) -> None:
    with closing(socket.create_connection(("127.0.0.1", proxy.port), timeout=0.3)) as raw:
        proxy.stall()
        raw.sendall(b"PUT / HTTP/1.1\r\nContent-Length: 4\r\nConnection: close\r\n\r\nkept")
        with pytest.raises(TimeoutError):
            raw.recv(1)
        proxy.let_through()
        raw.settimeout(10)
        assert b"".join(iter(lambda: raw.recv(1000), b"")).endswith(b"kept")


def test_cut_connections_end_and_new_ones_pass(proxy: Proxy) -> None:
    with closing(socket.create_connection(("127.0.0.1", proxy.port), timeout=10)) as raw:
        raw.sendall(b"PUT / HTTP/1.1\r\nContent-Length: 0\r\n\r\n")
        assert b"\r\n\r\n" in raw.recv(1000)
        proxy.cut()
        assert raw.recv(1) == b""
    assert httpx.put(f"http://127.0.0.1:{proxy.port}", content=b"new").content == b"new"


def test_refusing_proxy_takes_connections_again_when_told_to(proxy: Proxy, client: httpx.Client) -> None:
    proxy.refuse()
    with pytest.raises(httpx.ConnectError):
        client.put("/", content=b"1")
    proxy.let_through()
    assert client.put("/", content=b"2").content == b"2"


def test_statuses_are_answered_on_old_and_new_connections(proxy: Proxy, client: httpx.Client) -> None:
    assert client.put("/", content=b"1").status_code == 200
    proxy.answer(503)
    assert [client.put("/", content=bytes(500_000)).status_code for _ in range(3)] == [503, 503, 503]
    proxy.let_through()
    assert client.put("/", content=b"2").content == b"2"


def test_pulled_cable_loses_packets_for_those_inside_alone() -> None:
    with Network() as network:
        for port in echo(network.address):
            url = f"http://{network.address}:{port}/"
            ask = [*network.inside, "curl", "--silent", "--request", "PUT", "--data", "hello", url, "--max-time"]
            assert subprocess.run([*ask, "10"], capture_output=True, check=True).stdout == b"hello"
            network.pull()
            assert subprocess.run([*ask, "1"], capture_output=True, check=False).returncode == 28  # time is up
            assert httpx.put(url, content=b"hello").content == b"hello"
            network.plug()
            assert subprocess.run([*ask, "10"], capture_output=True, check=True).stdout == b"hello"
    until(lambda: network.address not in addresses(), "the link gone with its network", 10)


def addresses() -> str:
    return subprocess.run(["ip", "address"], stdout=subprocess.PIPE, text=True, check=True).stdout
