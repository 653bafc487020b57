"""A child process that does what it is told, faults included: `python faulty_worker.py DESCRIPTOR`."""

import os
import signal
import sys
import time
from pathlib import Path

from conicoid.errors import DeviceError, LimitError, Problem, SceneError
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
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


def handle(message: Message, blobs: list[Blob]) -> Reply:
    if message["do"].endswith(" once"):
        fault = message["do"].removesuffix(" once") if mark(message["mark"]) else "echo"
    else:
        fault = message["do"]
    match fault:
        case "abort":
            os.abort()
        case "segfault":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        case "exit":
            os._exit(3)
        case "hang":
            time.sleep(3600)
        case "sleep":
            time.sleep(message["seconds"])
        case "defect":
            raise ZeroDivisionError("a secret of the server's")
        case "scene":
            raise SceneError([Problem("quadrics[3].radius", "-1 is not > 0; give a positive radius", "scene-value")])
        case "limit":
            raise LimitError("pixels", 10, 11)
    return {"pid": os.getpid(), "environment": dict(os.environ)}, [Blob.of(blob.read()) for blob in blobs]


def mark(path: str) -> bool:
    """Whether this is the first call with this path."""
    try:
        Path(path).touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


if __name__ == "__main__":
    serve(start, sys.argv[1:])
