"""A service that runs for the measurement, and the bare connection that times its answers."""

import http.client
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final

_COMMAND: Final = "import sys; from conicoid_client.command import main; sys.exit(main())"
_START_S: Final = 180.0  # with every kernel to be compiled


class ServiceFailed(Exception):
    """The service did not start, or an answer is not what it should be."""


@dataclass(frozen=True)
class Answer:
    """One answer.

    Attributes:
        status: of HTTP.
        body: all of it.
        ms: from before the request was sent until all of the answer was here.
        tag: the entity tag.
        stages: the service's own account, milliseconds.
    """

    status: int
    body: bytes
    ms: float
    tag: str
    stages: dict[str, float]


class Connection:
    """One kept-alive connection to a service on this machine.

    Bodies arrive in memory that stays: fresh pages for an image of 7.5 MB would take the client 3.5 ms of its own.
    """

    def __init__(self, port: int) -> None:
        self._http = http.client.HTTPConnection("127.0.0.1", port, timeout=_START_S)
        self._memory = bytearray()

    def render(self, document: bytes, tag: str | None = None) -> Answer:
        """Have a document rendered, unless the image is still the one that `tag` names.

        Raises:
            ServiceFailed: the answer is neither an image nor 304.
        """
        headers = {"Content-Type": "application/json"} | ({} if tag is None else {"If-None-Match": tag})
        begin = time.perf_counter()
        self._http.request("POST", "/v1/render", document, headers)
        response = self._http.getresponse()
        received = self._receive(response)
        ms = 1e3 * (time.perf_counter() - begin)
        body = bytes(received)
        if response.status not in (200, 304):
            raise ServiceFailed(f"the service answered {response.status}: {body[:500].decode(errors='replace')}")
        stages = re.findall(r"(\w+);dur=([\d.]+)", response.headers["Server-Timing"])
        return Answer(response.status, body, ms, response.headers["ETag"], {name: float(dur) for name, dur in stages})

    def device(self) -> dict[str, Any]:
        """What the service renders with."""
        self._http.request("GET", "/v1/device")
        answer: dict[str, Any] = json.loads(self._http.getresponse().read())
        return answer

    def _receive(self, response: http.client.HTTPResponse) -> memoryview:
        """The body, of declared length, until the next one is received."""
        size = response.length or 0
        if size > len(self._memory):
            self._memory = bytearray(size)
        body, received = memoryview(self._memory)[:size], 0
        while received < size and (more := response.readinto(body[received:])):
            received += more
        response.read()  # the end, which frees the connection for the next request
        return body[:received]

    def close(self) -> None:
        """Let go of it."""
        self._http.close()


@contextmanager
def serving(device: str | None) -> Iterator[int]:
    """The port of a new service, which ends with the block.

    Raises:
        ServiceFailed: it did not come up.
    """
    environment = os.environ | ({} if device is None else {"CONICOID_DEVICE": device})
    command = [sys.executable, "-P", "-c", _COMMAND, "serve", "--port", "0"]
    with tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=log)
        try:
            while not (
                found := re.search(r"serving http://127\.0\.0\.1:(\d+)", os.pread(log.fileno(), 4096, 0).decode())
            ):
                if process.poll() is not None:
                    raise ServiceFailed(f"the service did not start: {os.pread(log.fileno(), 4096, 0).decode()}")
                time.sleep(0.002)
            yield int(found[1])
        finally:
            process.terminate()
            process.wait()
