"""Whatever goes wrong: the right exit status, one readable paragraph, no traceback and no half-written file."""

import os
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from tests.clients.command import CONICOID, ENVIRONMENT, conicoid, paragraph
from tests.clients.exr_files import exr_bytes, half_hit

FAILED, BAD_INPUT = 1, 2
PROBLEM_500 = b'{"code": "internal", "detail": "this request met a defect", "status": 500}'
PROBLEM_422 = (
    b'{"code": "scene-value", "detail": "d", "errors": [{"pointer": "a[0]", "message": "m", "code": "scene-value"}]}'
)


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A directory with something of everything."""
    (tmp_path / "scene.json").write_text("{}")
    (tmp_path / "image.exr").write_bytes(exr_bytes(half_hit()))
    (tmp_path / "cut.exr").write_bytes(exr_bytes(half_hit())[:-9])
    (tmp_path / "empty.exr").touch()
    (tmp_path / "colour.exr").write_bytes(exr_bytes({"R": half_hit()["Z"]}))
    (tmp_path / "directory").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    "arguments",
    [
        "",
        "rendre",
        "render",
        "render scene.json",
        "render scene.json -o out.exr --precision double",
        "render scene.json -o out.exr --preview out.exr",
        "render scene.json -o out.exr --server nonsense",
        "render scene.json -o out.exr --colour red",
        "preview image.exr",
        "preview image.exr -o out.png --width 0",
        "preview image.exr -o out.png --width 1e3",
        "preview image.exr -o out.png --background mauvish",
        "serve --port 65536",
        "serve --port http",
    ],
)
def test_bad_usage_is_2_and_says_what_is_wrong(arguments: str, here: Path) -> None:
    before = sorted(here.iterdir())
    done = conicoid(*arguments.split(), cwd=here)
    assert done.returncode == BAD_INPUT
    assert b"conicoid" in done.stderr
    assert b"Traceback" not in done.stderr
    assert sorted(here.iterdir()) == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("render missing.json -o out.exr", "missing.json: no such file"),
        ("render directory -o out.exr", "directory: is a directory"),
        ("render scene.json -o directory", "directory is a directory"),
        ("render scene.json -o missing/out.exr", "missing does not exist"),
        ("render scene.json -o out.exr --preview missing/out.png", "missing does not exist"),
        ("render scene.json -o out.exr --server http://127.0.0.1:9", "no answer from http://127.0.0.1:9"),
        ("render scene.json -o out.exr --server http://no.such.host.invalid", "no answer from"),
        ("canonical missing.json", "missing.json: no such file"),
        ("device --server http://127.0.0.1:9", "no answer"),
        ("info missing.exr", "missing.exr: no such file"),
        ("info directory", "directory: is a directory"),
        ("info empty.exr", "empty.exr: it is not an OpenEXR file"),
        ("info cut.exr", "cut.exr: it is not an OpenEXR file, or it is damaged"),
        ("info scene.json", "scene.json: it is not an OpenEXR file"),
        ("preview cut.exr -o out.png", "cut.exr: it is not"),
        ("preview colour.exr -o out.png", "only R"),
        ("preview image.exr -o missing/out.png", "missing does not exist"),
        ("preview image.exr -o /dev/full", "no space left on device"),
        ("serve --host no.such.host.invalid", "cannot listen on no.such.host.invalid"),
        ("serve --config missing.toml", "missing.toml: cannot be read: no such file"),
        ("serve --config scene.json", "scene.json: is not TOML"),
    ],
)
def test_any_other_failure_is_1_and_says_what_and_where(arguments: str, words: str, here: Path) -> None:
    before = sorted(here.iterdir())
    done = conicoid(*arguments.split(), cwd=here)
    assert done.returncode == FAILED
    assert words in paragraph(done)
    assert done.stdout == b""
    assert sorted(here.iterdir()) == before


def test_a_port_in_use_is_a_failure() -> None:
    with answering(200, b"{}") as address:
        done = conicoid("serve", "--port", address.rpartition(":")[2])
    assert done.returncode == FAILED
    assert "address already in use" in paragraph(done)


@contextmanager
def answering(status: int, body: bytes) -> Iterator[str]:
    """A server that gives the same answer to everything."""

    class Answer(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["Content-Length"]))
            self.send_response(status)
            self.send_header("Content-Type", "application/problem+json")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Answer) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


@pytest.mark.parametrize(
    ("status", "body", "code", "words"),
    [
        (500, PROBLEM_500, FAILED, "this request met a defect [internal]"),
        (502, b"<html>bad gateway</html>", FAILED, "502 Bad Gateway [http-502]"),
        (503, b"", FAILED, "503 Service Unavailable [http-503]"),
        (422, PROBLEM_422, BAD_INPUT, "a[0]: m [scene-value]"),
        (413, b"{}", BAD_INPUT, "413"),
        (200, b"not an image", FAILED, "is not image/x-exr; is this a Conicoid service?"),
    ],
)
def test_a_server_that_fails_is_reported_by_its_own_words(
    status: int, body: bytes, code: int, words: str, here: Path
) -> None:
    before = sorted(here.iterdir())
    with answering(status, body) as address:
        done = conicoid(
            "render", "scene.json", "-o", "out.exr", "--preview", "out.png", cwd=here, CONICOID_SERVER=address
        )
    assert done.returncode == code
    assert words in paragraph(done)
    assert sorted(here.iterdir()) == before


def test_many_problems_are_listed_up_to_a_few(here: Path) -> None:
    errors = ", ".join(f'{{"pointer": "quadrics[{k}]", "message": "bad"}}' for k in range(25))
    with answering(422, f'{{"errors": [{errors}]}}'.encode()) as address:
        done = conicoid("canonical", "scene.json", "--server", address, cwd=here)
    lines = paragraph(done).splitlines()
    assert done.returncode == BAD_INPUT
    assert lines[0] == "conicoid: the scene has 25 problems:"
    assert lines[1:3] == ["  quadrics[0]: bad", "  quadrics[1]: bad"]
    assert lines[-1] == "  and 15 more"


def test_a_scene_cannot_write_escape_sequences_to_the_terminal(here: Path) -> None:
    body = b'{"errors": [{"pointer": "\\u001b[31mred\\u0007", "message": "bad"}]}'
    with answering(422, body) as address:
        done = conicoid("canonical", "scene.json", "--server", address, cwd=here)
    assert b"\x1b" not in done.stderr
    assert b"\x07" not in done.stderr
    assert b"\\x1b[31mred" in done.stderr


CLOSED = (">&-", "standard output is closed")
FULL = (">/dev/full", "no space left on device")


@pytest.mark.parametrize(
    ("arguments", "redirection", "words"),
    [
        (arguments, *case)
        for arguments in ("info image.exr", "preview image.exr -o -", "device")
        for case in (CLOSED, FULL)
    ]
    + [(arguments, *FULL) for arguments in ("--help", "--version")],
)
def test_output_that_does_not_arrive_is_a_failure(arguments: str, redirection: str, words: str, here: Path) -> None:
    done = subprocess.run(
        ["sh", "-c", f"exec {CONICOID} {arguments} {redirection}"],
        cwd=here,
        stderr=subprocess.PIPE,
        check=False,
        env=ENVIRONMENT,
    )
    assert done.returncode == FAILED
    assert words in done.stderr.decode()
    assert len(done.stderr.splitlines()) == 1


def test_a_reader_that_has_gone_ends_the_command_quietly(here: Path) -> None:
    read_end, write_end = os.pipe()
    os.close(read_end)
    try:
        done = subprocess.run(
            [CONICOID, "info", "image.exr"],
            cwd=here,
            stdout=write_end,
            stderr=subprocess.PIPE,
            check=False,
            env=ENVIRONMENT,
        )
    finally:
        os.close(write_end)
    assert (done.returncode, done.stderr) == (FAILED, b"")


def test_closed_standard_error_does_not_change_the_exit_status(here: Path) -> None:
    mauvish = "preview image.exr -o - --background mauvish"
    for arguments, status in (("info cut.exr", FAILED), (mauvish, BAD_INPUT), ("info image.exr", 0)):
        done = subprocess.run(
            ["sh", "-c", f"exec {CONICOID} {arguments} 2>&-"],
            cwd=here,
            stdout=subprocess.PIPE,
            check=False,
            env=ENVIRONMENT,
        )
        assert done.returncode == status
        assert bool(done.stdout) == (status == 0)


def test_closed_standard_input_is_a_failure(here: Path) -> None:
    done = subprocess.run(
        ["sh", "-c", f"exec {CONICOID} info - <&-"], cwd=here, stderr=subprocess.PIPE, check=False, env=ENVIRONMENT
    )
    assert done.returncode == FAILED
    assert b"standard input is closed" in done.stderr
