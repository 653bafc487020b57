"""A child process that does what it is told, faults included: `python faulty_worker.py DESCRIPTOR`."""

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

from conicoid.errors import DeviceError, LimitError, Problem, SceneError
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.memory import limit_memory
from conicoid_service.worker import Handler, Reply, serve


def start(configuration: Message) -> tuple[Handler, Message]:
    match configuration.get("start"):
        case "refuse":
            raise DeviceError("no OpenCL device was found; install one")
        case "crash":
            os.abort()
        case "hang":
            time.sleep(3600)
        case "crash once" if configuration["after"] is None and mark(configuration["mark"]):
            os.abort()
    return handle, {"pid": os.getpid(), "after": configuration["after"]}


def refuse_scene() -> None:
    raise SceneError([Problem("quadrics[3].radius", "-1 is not > 0; give a positive radius", "scene-value")])


def refuse_limit() -> None:
    raise LimitError("pixels", 10, 11)


def too_large() -> None:
    limit_memory(1 << 30)
    bytearray(1 << 31)


def defect() -> None:
    raise ZeroDivisionError("a secret of the server's")


FAULTS: dict[str, Callable[[], None]] = {
    "abort": os.abort,
    "segfault": lambda: os.kill(os.getpid(), signal.SIGSEGV),
    "kill": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "exit": lambda: os._exit(3),
    "hang": lambda: time.sleep(3600),
    "scene": refuse_scene,
    "limit": refuse_limit,
    "defect": defect,
    "memory": too_large,
    "echo": lambda: None,
}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    """Do `message["do"]`, only the first time where it says `once`, then send the blobs back."""
    fault, *once = message["do"].split()
    if not once or mark(message["mark"]):
        FAULTS[fault]()
    time.sleep(message.get("seconds", 0))
    return {"pid": os.getpid()}, [Blob.of(blob.read()) for blob in blobs]


def mark(path: str) -> bool:
    """Whether this is the first call with this path."""
    try:
        Path(path).touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


if __name__ == "__main__":
    serve(start, sys.argv[1:])
