"""`conicoid canonical`: a scene with everything resolved, on standard output."""

import argparse

from conicoid_client import files
from conicoid_client.command.connect import connect
from conicoid_client.command.scene import read_scene


def run(options: argparse.Namespace) -> None:
    """Read, ask, print."""
    files.check_writable(files.STANDARD)
    scene, arrays = read_scene(options)
    with connect(options, warm=["document"]) as client:
        canonical = client.canonical(scene, arrays=arrays)
    files.write(files.STANDARD, canonical)
