"""Slow, endless and too many clients: each is let go of in its time, politely where HTTP allows."""

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx
import orjson
import pytest
import uvicorn

from conicoid_service.access.keys import Keys
from tests.checkout import ROOT
from tests.service.conftest import SCENE, uncached
from tests.service.test_server import LARGE, blobs, connection, head, serving, until

pytestmark = pytest.mark.usefixtures("nothing_left", "search_path")

QUICK: dict[str, Any] = {"head_timeout_s": 0.5, "body_timeout_s": 0.5, "send_timeout_s": 0.5}
GET = b"GET /livez HTTP/1.1\r\nHost: x\r\n"
DRIP_S = 0.05


def answer_of(bare: socket.socket) -> bytes:
    """All that comes until the server closes; it must, within some seconds."""
    bare.settimeout(10)
    received = b""
    try:
        while chunk := bare.recv(65536):
            received += chunk
    except ConnectionResetError:
        pass
    return received


def next_status(bare: socket.socket) -> int:
    """The status of the next answer, of which nothing is left unread."""
    received = b""
    while not (found := re.search(rb"content-length: (\d+)\r\n(?:.*\r\n)*?\r\n", received)) or (
        len(received) < found.end() + int(found[1])
    ):
        chunk = bare.recv(65536)
        assert chunk, received
        received += chunk
    return int(received.split()[1])


def problem_in(answer: bytes) -> dict[str, Any]:
    """The problem document of a response that says that the connection ends, with the status it has there."""
    head_lines, _, body = answer.partition(b"\r\n\r\n")
    headers = head_lines.lower()
    assert b"content-type: application/problem+json" in headers
    assert b"connection: close" in headers
    assert b"x-content-type-options: nosniff" in headers
    document: dict[str, Any] = orjson.loads(body)
    assert head_lines.startswith(f"HTTP/1.1 {document['status']} ".encode())
    return document


def drip(bare: socket.socket, data: bytes) -> None:
    """Send a byte at a time until the server has had enough; each alone would keep a timer of idleness from ending."""
    for byte in data:
        try:
            bare.sendall(bytes([byte]))
        except OSError:
            return
        time.sleep(DRIP_S)


def test_uvicorn_is_the_one_whose_connection_was_read() -> None:
    """`access.connection` overrides methods that are not documented: look at them again, then change this."""
    assert uvicorn.__version__.split(".")[:2] == ["0", "54"]


@pytest.mark.parametrize(
    "drops", [GET + b"X: " + b"x" * 60, b"\r\n" * 40, b"G" * 60], ids=["header", "lines", "method"]
)
@pytest.mark.parametrize("before", [b"", GET + b"\r\n"], ids=["first", "second"])
def test_a_head_that_drips_is_answered_408(before: bytes, drops: bytes) -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        bare.sendall(before)
        if before:
            assert next_status(bare) == 200
        started = time.monotonic()
        drip(bare, drops)
        answer = answer_of(bare)
        assert time.monotonic() - started < 5
        expected = {"bad-request"} if drops.startswith(b"GG") else {"head-timeout"}
        assert problem_in(answer)["code"] in expected


def test_a_connection_that_says_nothing_is_closed_without_a_word() -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        assert answer_of(bare) == b""


def test_a_slow_head_behind_a_request_that_is_being_answered_waits_for_that() -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        body = orjson.dumps(SCENE | {"quadrics": [SCENE["quadrics"][0] | {"name": "sleep 1.5"}]})
        bare.sendall(head(len(body)) + body + GET)
        first, _, rest = answer_of(bare).partition(b"\r\n\r\n")
        assert first.startswith(b"HTTP/1.1 200 ")
        assert b"head-timeout" in rest


def test_a_head_in_two_halves_is_answered() -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        bare.sendall(GET)
        time.sleep(0.2)
        bare.sendall(b"\r\n")
        assert next_status(bare) == 200


@pytest.mark.parametrize(
    "request_bytes",
    [
        GET + b"X: " + b"x" * 100_000 + b"\r\n\r\n",
        GET + b"X: x\r\n" * 20_000 + b"\r\n",
        b"GET /" + b"x" * 100_000,
        head("chunked") + b"1\r\n{\r\n0\r\nX: " + b"x" * 100_000,
        head("chunked") + b"1;" + b"x" * 100_000,
    ],
    ids=["header", "headers", "path", "trailer", "extension"],
)
def test_what_never_ends_is_refused_at_64_kilobytes(request_bytes: bytes) -> None:
    with serving() as client, connection(client) as bare:
        for start in range(0, len(request_bytes), 5000):
            try:
                bare.sendall(request_bytes[start : start + 5000])
            except OSError:
                break
            time.sleep(0.005)
        answer = answer_of(bare)
        assert not answer or problem_in(answer)["code"] == "head-limit"
        assert client.post("/v1/render", json=SCENE).status_code == 200


def test_a_head_that_comes_at_once_has_the_same_bound() -> None:
    with serving() as client, connection(client) as bare:
        bare.sendall(GET + b"X: " + b"x" * 60_000 + b"\r\n\r\n")
        assert next_status(bare) == 200
        bare.sendall(GET + b"X: " + b"x" * 66_000 + b"\r\n\r\n")
        assert problem_in(answer_of(bare))["code"] == "head-limit"


def test_a_body_that_stops_is_answered_408_and_leaves_nothing() -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        bare.sendall(head(1000) + b"{")
        assert problem_in(answer_of(bare))["code"] == "body-timeout"
        until(lambda: not blobs())


def test_a_body_that_drips_is_read_for_as_long_as_it_comes() -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        body = orjson.dumps(SCENE)[:30]
        bare.sendall(head(30))
        drip(bare, body)
        assert next_status(bare) == 400


def test_a_body_that_hardly_moves_is_refused_after_a_minute(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("conicoid_service.bodies._PATIENCE_S", 0.5)
    with serving(uncached(body_timeout_s=5.0)) as client, connection(client) as bare:
        bare.sendall(head(1000))
        drip(bare, b" " * 100)
        assert problem_in(answer_of(bare))["code"] == "body-timeout"


def test_the_rest_of_a_body_that_is_refused_is_not_awaited_for_ever() -> None:
    with serving(uncached(**QUICK, api_keys=Keys.parse("key"))) as client, connection(client) as bare:
        bare.sendall(head(1000) + b"{")
        assert next_status(bare) == 401
        started = time.monotonic()
        drip(bare, b" " * 100)
        assert answer_of(bare) == b""
        assert time.monotonic() - started < 4


def test_a_long_body_behind_a_request_that_was_answered_has_its_time() -> None:
    with serving(uncached(**QUICK)) as client, connection(client) as bare:
        bare.sendall(GET + b"\r\n" + head(30))
        assert next_status(bare) == 200
        drip(bare, orjson.dumps(SCENE)[:30])
        assert next_status(bare) == 400


def test_a_refused_body_that_is_sent_in_full_leaves_the_connection_usable() -> None:
    with serving(uncached(api_keys=Keys.parse("key"))) as client, connection(client) as bare:
        bare.sendall(head(1000))
        assert next_status(bare) == 401
        bare.sendall(b" " * 1000 + GET + b"\r\n")
        assert next_status(bare) == 200


def test_one_connection_too_many_is_told_so_and_the_others_stay() -> None:
    with serving(uncached(connection_limit=3)) as client:
        kept = [connection(client) for _ in range(3)]
        for bare in kept:
            bare.sendall(GET)
        time.sleep(0.2)
        with connection(client) as refused:
            assert problem_in(answer_of(refused))["code"] == "connection-limit"
        kept[0].close()
        for bare in kept[1:]:
            bare.sendall(b"\r\n")
            assert next_status(bare) == 200
            bare.close()
        until(lambda: client.get("/livez").status_code == 200)


def asks_and_reads_nothing(client: httpx.Client) -> socket.socket:
    """A connection with a small window, over which an image of many megabytes is asked for."""
    assert client.base_url.port
    bare = socket.socket()
    bare.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    bare.connect((client.base_url.host, client.base_url.port))
    body = orjson.dumps(LARGE)
    bare.sendall(head(len(body)) + body)
    return bare


def test_a_client_that_reads_nothing_holds_no_process_and_is_cut_off() -> None:
    with serving(uncached(send_timeout_s=2.0)) as client, asks_and_reads_nothing(client):
        until(lambda: len(blobs()) == 1)
        assert client.post("/v1/render", json=SCENE).status_code == 200
        assert len(blobs()) == 1
        until(lambda: not blobs())


def test_a_client_that_reads_slowly_but_reads_gets_all() -> None:
    with serving(uncached(send_timeout_s=0.5)) as client:
        started = time.monotonic()
        with client.stream("POST", "/v1/render", json=LARGE) as response:
            received = 0
            for chunk in response.iter_raw(1 << 20):
                received += len(chunk)
                time.sleep(0.02)
        assert received == int(response.headers["content-length"])
        assert time.monotonic() - started > 1


PROGRAM = """
import sys
from conicoid_service.server import serve
from conicoid_service.settings import Settings
raise SystemExit(not serve(port=0, settings=Settings(send_timeout_s=600, head_timeout_s=600, body_timeout_s=600)))
"""


def test_clients_that_read_or_send_nothing_do_not_hold_up_a_stop(tmp_path: Path) -> None:
    log = tmp_path / "log"
    environment = {**os.environ, "CONICOID_API_KEYS": "key"}
    with (
        log.open("w") as output,
        subprocess.Popen([sys.executable, "-c", PROGRAM], cwd=ROOT, stderr=output, env=environment) as server,
    ):
        until(lambda: "http://127.0.0.1:" in log.read_text())
        address = log.read_text().split("http://")[1].split()[0]
        with httpx.Client(base_url=f"http://{address}", timeout=120) as client:
            client.get("/v1/device").raise_for_status()
            children = Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text().split()
            assert not any(b"API_KEYS" in Path(f"/proc/{child}/environ").read_bytes() for child in children)
            held = [asks_and_reads_nothing(client), connection(client), connection(client)]
            held[1].sendall(GET)
            held[2].sendall(head(1000))
            time.sleep(2)
            started = time.monotonic()
            server.send_signal(signal.SIGTERM)
            server.wait(timeout=30)
            elapsed_s = time.monotonic() - started
            answers = [answer_of(bare) for bare in held[1:]]
            for bare in held:
                bare.close()
    assert server.returncode == 0
    assert "Traceback" not in log.read_text()
    assert elapsed_s < 10  # the 8 s of grace, and the children's end
    assert answers[0] == b""
    assert problem_in(answers[1])["code"] == "stopping"
