"""Arguments in, exit status out: 0 done; 2 bad usage or bad scene; 1 anything else."""

import argparse
import os
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import NoReturn

from conicoid_client.command.arguments import parser
from conicoid_client.command.report import report

DONE, FAILED, BAD_INPUT, INTERRUPTED, TERMINATED = 0, 1, 2, 128 + signal.SIGINT, 128 + signal.SIGTERM


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; never raises, so never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    signal.signal(signal.SIGTERM, _terminate)
    try:
        try:
            _run(arguments)
        finally:
            _deliver()
    except BrokenPipeError:
        return FAILED  # whoever read our output has gone; there is nobody to tell
    except KeyboardInterrupt:
        return INTERRUPTED
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else FAILED
    except Exception as error:  # noqa: BLE001 -- a traceback is a defect, whatever happened
        return BAD_INPUT if report(error) else FAILED
    return DONE


def _run(arguments: Sequence[str] | None) -> None:
    options = parser().parse_args(arguments)
    run: Callable[[argparse.Namespace], None] = import_module(f"conicoid_client.command.{options.command}").run
    run(options)


def _deliver() -> None:
    """Flush standard output; what it does not take is dropped, or the interpreter would complain of it at its end."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise


def _terminate(_signal: int, _frame: object) -> NoReturn:
    raise SystemExit(TERMINATED)
