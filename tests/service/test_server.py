"""Over a real socket: rude clients cost nothing, and a stop is orderly."""

import json
import logging
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from conicoid_service.app import create_app
from conicoid_service.pipeline import Pipeline
from conicoid_service.server import server_of
from conicoid_service.settings import Settings
from tests.checkout import ROOT
from tests.service.conftest import FAKE, SCENE, descriptors, named, uncached

pytestmark = pytest.mark.usefixtures("nothing_left", "search_path")

LARGE = SCENE | {"camera": {"width": 3000, "height": 2000, "fov_y": 40}, "output": {"compression": "none"}}

UNCACHED = uncached()


@contextmanager
def serving(settings: Settings = UNCACHED) -> Iterator[httpx.Client]:
    """A client of a server in a thread of this process, with the fake render process."""
    listener = socket.create_server(("127.0.0.1", 0))
    server = server_of(create_app(settings, Pipeline(settings, FAKE)), settings, log_config=None)
    thread = threading.Thread(target=server.run, args=([listener],))
    thread.start()
    host, port = listener.getsockname()
    try:
        with httpx.Client(base_url=f"http://{host}:{port}", timeout=60) as client:
            yield client
    finally:
        server.should_exit = True
        thread.join()
        listener.close()


def connection(client: httpx.Client) -> socket.socket:
    """A bare connection to the client's server."""
    assert client.base_url.port
    return socket.create_connection((client.base_url.host, client.base_url.port), timeout=30)


def head(length: int | str, path: str = "/v1/render") -> bytes:
    """The head of a request with a JSON body of this declared length, or of this transfer encoding."""
    framing = f"Content-Length: {length}" if isinstance(length, int) else f"Transfer-Encoding: {length}"
    return f"POST {path} HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n{framing}\r\n\r\n".encode()


def until(condition: Callable[[], bool]) -> None:
    """Wait for what must come; a test that hangs here has failed."""
    give_up = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < give_up
        time.sleep(0.01)


def blobs() -> set[str]:
    return {held for held in descriptors() if held.startswith("/memfd")}


def test_an_image_arrives_whole() -> None:
    with serving() as client:
        response = client.post("/v1/render", json=LARGE)
        assert response.status_code == 200
        assert len(response.content) == int(response.headers["content-length"]) > 4 * 4 * 3000 * 2000
        assert "date" in response.headers


def test_a_huge_declared_body_is_refused_before_it_is_sent() -> None:
    with serving() as client, connection(client) as bare:
        bare.sendall(head(10**15))
        answer = bare.recv(65536)
        assert answer.startswith(b"HTTP/1.1 413 ")
        assert b"application/problem+json" in answer


def test_an_endless_chunked_body_is_refused_at_the_limit() -> None:
    with serving(uncached(body_limit=100_000)) as client, connection(client) as bare:
        bare.sendall(head("chunked"))
        chunk = b"2710\r\n" + b" " * 10_000 + b"\r\n"
        for _ in range(11):
            bare.sendall(chunk)
        assert bare.recv(65536).startswith(b"HTTP/1.1 413 ")


def test_a_client_that_leaves_in_the_middle_of_its_body_leaves_nothing() -> None:
    with serving() as client:
        with connection(client) as bare:
            bare.sendall(head(1000) + b"{")
            until(lambda: len(blobs()) == 1)
        until(lambda: not blobs())
        assert client.post("/v1/render", json=SCENE).status_code == 200


def test_a_client_that_leaves_while_it_waits_is_not_rendered_for(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "conicoid_service")
    with serving() as client, connection(client) as first, connection(client) as second:
        client.get("/v1/device")
        body = json.dumps(named(f"until {tmp_path / 'go'}")).encode()
        first.sendall(head(len(body)) + body)
        time.sleep(0.3)
        poison = json.dumps(named("abort")).encode()
        second.sendall(head(len(poison)) + poison)
        time.sleep(0.3)
        first.close()
        second.close()
        until(lambda: caplog.text.count("a client went away") == 2)
        (tmp_path / "go").touch()
        assert client.post("/v1/render", json=SCENE).status_code == 200
    assert "SIGABRT" not in caplog.text


def test_a_client_that_leaves_in_the_middle_of_an_image_leaves_nothing() -> None:
    with serving() as client:
        with client.stream("POST", "/v1/render", json=LARGE) as response:
            assert next(response.iter_raw())
            assert len(blobs()) == 1
        until(lambda: not blobs())
        assert client.post("/v1/render", json=SCENE).status_code == 200


def test_the_loop_answers_while_a_large_document_is_read_and_rendered() -> None:
    """Reading it takes hundreds of times as long as a probe: one that waited for it would be one of a few."""
    many = SCENE | {"quadrics": [{"shape": "sphere", "center": [0.1 * i, 1.25, -3.5]} for i in range(100_000)]}
    with serving() as client, ThreadPoolExecutor() as beside:
        client.get("/v1/device")
        rendering = beside.submit(client.post, "/v1/render", json=many)
        probes = 0
        while not rendering.done():
            assert client.get("/livez").status_code == 200
            probes += 1
        assert rendering.result().status_code == 200
    assert probes >= 20


@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_server_and_its_children(ending: signal.Signals, tmp_path: Path) -> None:
    program = "from conicoid_service.server import serve; raise SystemExit(not serve(port=0))"
    log = tmp_path / "log"
    with log.open("w") as output, subprocess.Popen([sys.executable, "-c", program], cwd=ROOT, stderr=output) as server:
        until(lambda: "http://127.0.0.1:" in log.read_text())
        children = Path(f"/proc/{server.pid}/task/{server.pid}/children")
        address = log.read_text().split("http://")[1].split()[0]
        httpx.get(f"http://{address}/v1/device", timeout=120).raise_for_status()
        server.send_signal(ending)
        server.wait(timeout=30)
        assert not children.exists()
    assert server.returncode == 0
    assert "Traceback" not in log.read_text()
