"""`conicoid submit`: a batch of cameras in, a folder of frames out."""

import argparse
import sys

from conicoid_client import files
from conicoid_client.command.connect import connect_to_server
from conicoid_client.command.follow import folder, follow, resume_hint
from conicoid_client.command.report import UsageError
from conicoid_client.command.scene import read_scene


def run(options: argparse.Namespace) -> None:
    """Read, submit, and unless told not to, wait and fetch; what can be refused is refused before the work."""
    if options.output is None and not options.detach:
        raise UsageError("say where the frames go with -o DIR, or leave the job to the service with --detach")
    with connect_to_server(options) as client:
        frames = None if options.detach else folder(options.output)
        scene, arrays = read_scene(options)
        job = client.submit(scene, arrays=arrays, idempotency_key=options.idempotency_key, priority=options.priority)
    if options.detach:
        files.say(job.id)
        if sys.stderr is not None:
            print(f"fetch its frames with: {resume_hint(options, job.id)}", file=sys.stderr)
        return
    follow(options, job, frames)
