"""The scene that a command is given: its document, and the arrays beside it."""

import argparse

from conicoid_client import files
from conicoid_client.command.report import UsageError


def read_scene(options: argparse.Namespace) -> tuple[bytes, bytes | None]:
    """The bytes of SCENE.json and of the .npz file, None without one.

    Raises:
        UsageError: both are standard input.
        OSError: one of them cannot be read.
    """
    if options.scene == options.arrays == files.STANDARD:
        raise UsageError("the scene and --arrays are both standard input; give one of them as a file")
    return files.read(options.scene), None if options.arrays is None else files.read(options.arrays)
