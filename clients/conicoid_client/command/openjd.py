"""Lines on standard output that a scheduler of Open Job Description reads: progress, status and the cause of a failure.

Format: Open Job Description, "How Jobs Are Run", 2023-09.
"""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager

from conicoid_client import files
from conicoid_client.command.report import UsageError, one_line


@contextmanager
def lines(options: argparse.Namespace, status: str) -> Iterator[None]:
    """Say with `--progress openjd` what is being done, that it is, and why it could not be.

    Raises:
        UsageError: the result goes to standard output, too.
    """
    if options.progress is None:
        yield
        return
    if files.STANDARD in (options.output, getattr(options, "preview", None)):
        raise UsageError("--progress prints on standard output; give -o, and --preview, the name of a file")
    files.say(f"openjd_status: {one_line(status)}\nopenjd_progress: 0")
    try:
        yield
    except Exception as error:
        files.say(f"openjd_fail: {one_line(error)}")
        raise
    files.say("openjd_progress: 100")
