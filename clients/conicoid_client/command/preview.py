"""`conicoid preview`: a picture of an OpenEXR file."""

import argparse

from conicoid_client import files
from conicoid_client.command.report import Failure, UsageError


def run(options: argparse.Namespace) -> None:
    """Read the file and write its picture."""
    files.check_writable(options.output)
    data = files.read(options.image)
    from conicoid_client import exr, picture

    try:
        image = exr.decode(data)
        png = picture.png(image, width=options.width, background=options.background)
    except exr.ExrError as error:
        raise Failure(f"{options.image}: {error}") from None
    except picture.ColourError as error:
        raise UsageError(f"--background: {error}") from None
    files.write(options.output, png)
