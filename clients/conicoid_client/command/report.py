"""Telling a person what went wrong, in one readable paragraph on standard error."""

import os
import shutil
import sys
import textwrap

from conicoid_client.errors import ClientError, ProblemError, SceneRejected

MOST_PROBLEMS = 10


class UsageError(Exception):
    """The command line asks for something that makes no sense; exit status 2."""


class Failure(Exception):
    """The command could not do its work; exit status 1. The message is the whole paragraph."""


def report(error: Exception) -> bool:
    """Print the error; True where the user's command line or scene is to blame, so that it is no use to try again."""
    if sys.stderr is not None:
        print("\n".join(_layout(_lines(error))), file=sys.stderr)
    return isinstance(error, UsageError | SceneRejected)


def one_line(said: Exception | str) -> str:
    """An error, or any text, for a reader of lines."""
    lines = [said] if isinstance(said, str) else _lines(said)
    return " ".join(_printable(line) for text in lines for line in text.splitlines())


def _lines(error: Exception) -> list[str]:
    if isinstance(error, ProblemError):
        return _problem_lines(error)
    if isinstance(error, OSError) and error.strerror:
        named = f"{os.fsdecode(error.filename)}: " if isinstance(error.filename, str | bytes) else ""
        return [named + error.strerror[0].lower() + error.strerror[1:]]
    if isinstance(error, ClientError | UsageError | Failure | OSError):
        return [str(error)]
    return [f"this is a defect in conicoid, please report it: {type(error).__name__}: {error}"]


def _problem_lines(error: ProblemError) -> list[str]:
    problems = [str(problem) for problem in error.problems]
    if error.status == 401:
        remedy = "is CONICOID_API_KEY right?" if os.environ.get("CONICOID_API_KEY") else "set CONICOID_API_KEY to one"
        return [f"{error.detail} [{error.code}]", f"the service lets in who has an API key; {remedy}"]
    if not problems:
        return [f"{error.detail} [{error.code}]"]
    if len(problems) == 1:
        return problems
    shown = problems[:MOST_PROBLEMS]
    more = len(problems) - len(shown)
    return [f"the scene has {len(problems)} problems:", *shown, *([f"and {more} more"] if more else [])]


def _layout(lines: list[str]) -> list[str]:
    """Prefix, indent and, on a terminal, wrap; elsewhere a line stays whole, for grep."""
    first, *rest = [_printable(line) for text in lines for line in text.splitlines()] or [""]
    width = shutil.get_terminal_size().columns if sys.stderr.isatty() else 0
    return [
        *_wrap(first, "conicoid: ", "  ", width),
        *(part for line in rest for part in _wrap(line, "  ", "    ", width)),
    ]


def _wrap(line: str, initial: str, subsequent: str, width: int) -> list[str]:
    if width < 40:
        return [initial + line]
    return textwrap.wrap(
        line,
        width,
        initial_indent=initial,
        subsequent_indent=subsequent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _printable(line: str) -> str:
    """A scene's own text cannot move the cursor or ring the bell."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)
