"""The arguments of `conicoid jobs`."""

import argparse

from conicoid_client.command.numbers import frame, samples

_STATES = ("queued", "running", "succeeded", "failed", "cancelled")
_SERVER = "the service, as in http://127.0.0.1:8000 (default: $CONICOID_SERVER)"


def add_jobs(jobs: argparse.ArgumentParser) -> None:
    """Add one for each thing that can be done with jobs."""
    actions = jobs.add_subparsers(dest="action", metavar="ACTION", required=True)

    def action(name: str, summary: str, *, of_one: bool = True) -> argparse.ArgumentParser:
        added = actions.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")
        if of_one:
            added.add_argument("id", metavar="ID")
        added.add_argument("--server", metavar="URL", help=_SERVER)
        return added

    listing = action("list", "list jobs, newest first", of_one=False)
    listing.add_argument("--state", choices=_STATES, help="those in this state alone")
    listing.add_argument("--limit", type=samples, default=50, metavar="N", help="at most N (default: %(default)s)")
    listing.add_argument("--json", action="store_true", help="as JSON")

    show = action("show", "say how a job stands")
    show.add_argument("--json", action="store_true", help="as JSON, with every frame")

    wait = action("wait", "wait until a job has ended, and fetch its frames as they end")
    wait.add_argument("-o", "--output", metavar="DIR", help="for frame-00000.exr and so on")

    fetch = action("fetch", "fetch the frames that are there now")
    fetch.add_argument("-o", "--output", required=True, metavar="DIR", help="for frame-00000.exr and so on")
    fetch.add_argument("--frame", type=frame, metavar="K", help="this one alone, from 0")

    action("cancel", "cancel a job; the frames that are done stay until it expires")
