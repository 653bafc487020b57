"""A running service for the tests that need one."""

import signal
import socket
import subprocess
import time
from collections.abc import Iterator

import pytest

from tests.clients.command import CONICOID


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A running `conicoid serve`, gone before the tests that kill their children; it ends orderly, with status 0."""
    log = tmp_path_factory.mktemp("serve") / "log"
    with log.open("wb") as stderr:
        server = subprocess.Popen([CONICOID, "serve", "--port", "0"], stdout=subprocess.DEVNULL, stderr=stderr)
    try:
        while not (words := log.read_text().split())[:1]:
            assert server.poll() is None, log.read_text()
            time.sleep(0.05)
        assert words[0] == "serving"
        yield words[1]
    finally:
        server.send_signal(signal.SIGTERM)
        assert server.wait(30) == 0


@pytest.fixture
def unused_port() -> int:
    """A port that nobody listens on just now."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port: int = listener.getsockname()[1]
        return port
