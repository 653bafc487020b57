"""`conicoid canonical`: a scene with everything resolved, on standard output."""

import argparse

from conicoid_client import files
from conicoid_client.command.connect import connect


def run(options: argparse.Namespace) -> None:
    """Read, ask, print."""
    files.check_writable(files.STANDARD)
    scene = files.read(options.scene)
    with connect(options) as client:
        canonical = client.canonical(scene)
    files.write(files.STANDARD, canonical)
