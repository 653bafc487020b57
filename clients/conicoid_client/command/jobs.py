"""`conicoid jobs`: jobs of a service, seen, awaited, fetched and cancelled."""

import argparse
import json
import sys
from collections.abc import Iterable
from dataclasses import asdict
from datetime import datetime
from itertools import islice
from typing import TYPE_CHECKING, Any

from conicoid_client import files
from conicoid_client.command.connect import connect_to_server
from conicoid_client.command.follow import Outcome, conclude, folder, follow, resume_hint, unwritten
from conicoid_client.command.report import MOST_PROBLEMS, Failure
from conicoid_client.jobs import Frame, Job

if TYPE_CHECKING:
    from conicoid_client.client import Client


def run(options: argparse.Namespace) -> None:
    """Do what was asked for."""
    with connect_to_server(options) as client:
        if options.action == "list":
            _list(options, client)
        elif options.action == "show":
            _show(options, client)
        elif options.action == "wait":
            job = client.job(options.id)
            follow(options, job, None if options.output is None else folder(options.output))
        elif options.action == "fetch":
            _fetch(options, client)
        else:
            job = client.cancel(options.id)
            files.say(f"job {job.id} {'is' if job.state == 'cancelled' else 'had'} {job.state}: {_frames(job)} done")


def _list(options: argparse.Namespace, client: "Client") -> None:
    jobs = list(islice(client.jobs(options.state), options.limit))
    if options.json:
        files.say(json.dumps([_plain(job) for job in jobs], indent=2))
    elif jobs:
        _print_table(jobs)
    elif sys.stderr is not None:
        print("no jobs", file=sys.stderr)


def _print_table(jobs: Iterable[Job]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    files.check_writable(files.STANDARD)
    table = Table("id", "state", "frames", "created", "finished", "expires", box=None, pad_edge=False)
    for job in jobs:
        times = (job.created, job.finished, job.expires)
        table.add_row(*map(Text, (job.id, job.state, _frames(job), *map(_when, times))))
    # In a file or a pipe a row stays one line, for grep.
    Console(width=None if sys.stdout.isatty() else 1000).print(table)


def _show(options: argparse.Namespace, client: "Client") -> None:
    job = client.job(options.id)
    if options.json:
        frames = [_plain(frame) for frame in client.frames(job.id)]
        files.say(json.dumps({**_plain(job), "frames": frames}, indent=2))
        return
    lines = [f"job       {job.id}", f"state     {job.state}", f"frames    {_frames(job)}"]
    for name, time in (("created", job.created), ("started", job.started), ("finished", job.finished),
                       ("expires", job.expires)):  # fmt: skip
        lines.append(f"{name:<9} {_when(time)}")
    if job.frames_failed:
        failed = list(islice((f for f in client.frames(job.id) if f.state == "failed"), MOST_PROBLEMS))
        lines += [f"frame {frame.number} failed: {frame.error_detail} [{frame.error_code}]" for frame in failed]
    files.say("\n".join(lines))


def _fetch(options: argparse.Namespace, client: "Client") -> None:
    job = client.job(options.id)
    target = folder(options.output)
    outcome, saved = Outcome(job), 0
    try:
        if options.frame is not None:
            # What is not there is asked for all the same: the answer says why.
            target.save(client, job.id, Frame(options.frame, job.state, None, None, None, None))
            return
        for frame in client.frames(job.id):
            if frame.state == "succeeded":
                target.save(client, job.id, frame)
                saved += 1
            elif frame.state == "failed":
                outcome.failed.append(frame)
    except OSError as error:
        raise Failure(f"{unwritten(options.output, error)}\ngo on with: {resume_hint(options, job.id)}") from None
    if job.ended:
        conclude(options, outcome)
    elif sys.stderr is not None:
        print(f"job {job.id} is {job.state}: {saved} of {job.frames_total} frames are in {options.output}",
              file=sys.stderr)  # fmt: skip


def _frames(job: Job) -> str:
    failed = f", {job.frames_failed} failed" if job.frames_failed else ""
    return f"{job.frames_done}/{job.frames_total}{failed}"


def _when(time: datetime | None) -> str:
    return "-" if time is None else time.astimezone().isoformat(" ", "seconds")


def _plain(record: Job | Frame) -> dict[str, Any]:
    return {name: value.isoformat() if isinstance(value, datetime) else value for name, value in asdict(record).items()}
