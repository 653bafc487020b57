"""The child's side of supervision: report ready, then answer one message at a time until the parent is gone."""

import ctypes
import logging
import os
import signal
import socket
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress

from conicoid.errors import ConicoidError, LimitError, SceneError
from conicoid_service.blob import Blob
from conicoid_service.channel import Channel, Message
from conicoid_service.errors import DEFECT
from conicoid_service.heap import keep_freed_memory
from conicoid_service.memory import out_of_memory
from conicoid_service.telemetry import context
from conicoid_service.telemetry.logs import LOG_FORMAT, configure

Reply = tuple[Message, list[Blob]]
Handler = Callable[[Message, list[Blob]], Reply]
Start = Callable[[Message], tuple[Handler, Message]]

_PR_SET_PDEATHSIG = 1


def serve(start: Start, arguments: Sequence[str]) -> None:
    """Serve the parent until it closes its end of the socket.

    Args:
        start: gets the parent's configuration, returns the handler and what to tell the parent about this process;
            a ConicoidError from it is reported to the parent.
        arguments: the command line's, one descriptor.
    """
    configure(os.environ.get(LOG_FORMAT, "text"))
    _die_with_parent()
    keep_freed_memory()
    with socket.socket(fileno=int(arguments[0])) as connection, suppress(EOFError, BrokenPipeError):
        # The end of the work is the parent's end of the socket: closed, or gone with the parent.
        _converse(Channel(connection), start)


def _converse(channel: Channel, start: Start) -> None:
    configuration, _ = channel.receive()
    try:
        handler, hello = start(configuration)
    except ConicoidError as error:
        channel.send(failure(error))
        return
    except MemoryError:
        channel.send(failure(out_of_memory()))
        return
    channel.send({"ready": hello})
    while True:
        _answer(channel, handler, *channel.receive())


def failure(error: ConicoidError) -> Message:
    """An error as a message, which `ReportedError.from_report` makes an exception again."""
    report: Message = {"code": error.code, "detail": str(error)}
    if isinstance(error, SceneError):
        report["problems"] = [[problem.pointer, problem.message, problem.code] for problem in error.problems]
    if isinstance(error, LimitError):
        report |= {"limit": error.limit, "asked": error.asked}
    return {"failed": report}


def _answer(channel: Channel, handler: Handler, message: Message, blobs: list[Blob]) -> None:
    results: list[Blob] = []
    context.adopt(message)
    try:
        reply, results = handler(message, blobs)
    except ConicoidError as error:
        reply = failure(error)
    except MemoryError:
        reply = failure(out_of_memory())
    except Exception:
        logging.getLogger(__name__).exception("a request failed in a way that is a defect")
        reply = {"failed": {"code": "internal", "detail": DEFECT}}
    try:
        channel.send(reply, results)
    finally:
        for blob in (*blobs, *results):
            blob.close()


def _die_with_parent() -> None:
    """Have the kernel end this process with its parent, even in the middle of a kernel that never returns.

    The signal comes when the parent's *thread* that started this process ends: the supervisor keeps that thread.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
