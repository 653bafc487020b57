"""Waiting for a job, with its progress on standard error, and fetching its frames as they end."""

import argparse
import shlex
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from conicoid_client.command.connect import connect_to_server, server
from conicoid_client.command.report import MOST_PROBLEMS, Failure
from conicoid_client.errors import ProblemError, ServerBusy, Unreachable
from conicoid_client.frame_files import FrameFiles
from conicoid_client.jobs import Event, Frame, FrameEnded, Job, JobEnded

# A service that is started anew on a slow machine, or an update of it.
_PATIENCE_S = 300.0
_LINE_EVERY_S = 10.0


@dataclass
class Outcome:
    """What became of a job, and the frames of it that are known to have failed."""

    job: Job
    failed: list[Frame] = field(default_factory=list)


def folder(path: str) -> FrameFiles:
    """The folder for the frames.

    Raises:
        Failure: it cannot be written.
    """
    try:
        return FrameFiles(Path(path))
    except OSError as error:
        raise Failure(unwritten(path, error)) from None


def follow(options: argparse.Namespace, job: Job, frames: FrameFiles | None) -> None:
    """Wait until a job has ended; its frames go to `frames` as they end. A service that starts anew is waited for.

    Raises:
        Failure: not every frame succeeded, or something came between; it says how to go on.
        KeyboardInterrupt: the user did; the job goes on, and the user is told how to come back to it.
    """
    outcome = Outcome(job)
    with (
        _explained(options, job),
        connect_to_server(options, patience_s=_PATIENCE_S) as client,
        _shown(job) as show,
    ):
        for event in client.events(job.id):
            if isinstance(event, FrameEnded):
                if event.frame.state == "failed":
                    outcome.failed.append(event.frame)
                elif event.frame.state == "succeeded" and frames is not None:
                    frames.save(client, job.id, event.frame)
            show(event)
            if isinstance(event, JobEnded):
                outcome.job = event.job
    conclude(options, outcome)


@contextmanager
def _explained(options: argparse.Namespace, job: Job) -> Iterator[None]:
    """What comes between, with how to go on."""
    hint = resume_hint(options, job.id)
    try:
        yield
    except KeyboardInterrupt:
        _say(f"job {job.id} goes on; come back to it with: {hint}")
        raise
    except OSError as error:
        if options.output is None:
            raise
        raise Failure(f"{unwritten(options.output, error)}\ngo on with: {hint}") from None
    except (Unreachable, ServerBusy) as error:
        raise Failure(f"{error}\ngo on with: {hint}") from None
    except ProblemError as error:
        if error.code == "unknown-job":
            raise Failure(f"job {job.id} is not there any more; its frames are gone when it expires") from None
        raise


def conclude(options: argparse.Namespace, outcome: Outcome) -> None:
    """Say what became of a job that has ended; Failure if not every frame has an image."""
    job, where = outcome.job, "" if options.output is None else f" in {options.output}"
    if job.state == "succeeded":
        _say(f"job {job.id}: all {job.frames_total} frames are {'done' if not where else where.strip()}")
        return
    if job.state == "cancelled":
        raise Failure(f"job {job.id} was cancelled: {job.frames_done} of {job.frames_total} frames are done{where}")
    shown = [f"frame {f.number}: {f.error_detail} [{f.error_code}]" for f in outcome.failed[:MOST_PROBLEMS]]
    more = len(outcome.failed) - len(shown)
    first = f"{job.frames_failed} of {job.frames_total} frames of job {job.id} failed; the others are done{where}"
    raise Failure("\n".join([first, *shown, *([f"and {more} more"] if more > 0 else [])]))


def resume_hint(options: argparse.Namespace, job_id: str) -> str:
    """The command that goes on with a job."""
    output = ["-o", options.output or "DIR"]
    return shlex.join(["conicoid", "jobs", "wait", job_id, *output, "--server", server(options) or "URL"])


@contextmanager
def _shown(job: Job) -> Iterator[Callable[[Event], None]]:
    """A bar on a terminal, elsewhere a line now and then; what is shown never goes back."""
    ended = said_at = 0.0

    def count(event: Event) -> float:
        nonlocal ended
        counts = event if isinstance(event, FrameEnded) else event.job
        ended = max(ended, counts.frames_done + counts.frames_failed)
        return ended

    if sys.stderr is None or not sys.stderr.isatty():
        _say(f"job {job.id}: {job.frames_total} frames")
        said_at = time.monotonic()

        def line(event: Event) -> None:
            nonlocal said_at
            before = ended
            if count(event) > before and time.monotonic() - said_at >= _LINE_EVERY_S:
                said_at = time.monotonic()
                _say(f"job {job.id}: {ended:.0f} of {job.frames_total} frames")

        yield line
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn(),
               TimeRemainingColumn())  # fmt: skip
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(f"job {job.id}", total=job.frames_total)
        yield lambda event: bar.update(task, completed=count(event))


def unwritten(path: str, error: OSError) -> str:
    """Why frames cannot be written to a folder."""
    cause = str(error)
    if error.strerror:
        named = f"{error.filename}: " if isinstance(error.filename, str) else ""
        cause = named + error.strerror[0].lower() + error.strerror[1:]
    return f"frames cannot be written to {path}: {cause}"


def _say(text: str) -> None:
    if sys.stderr is not None:
        print(text, file=sys.stderr, flush=True)
