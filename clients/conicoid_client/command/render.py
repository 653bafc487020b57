"""`conicoid render`: a scene document in, an OpenEXR file and perhaps a picture out."""

import argparse
import sys
import time
from typing import TYPE_CHECKING

from conicoid_client import files
from conicoid_client.command import openjd
from conicoid_client.command.connect import connect
from conicoid_client.command.progress import progress
from conicoid_client.command.report import UsageError
from conicoid_client.command.scene import read_scene

if TYPE_CHECKING:
    from conicoid_client.rendering import Rendering


def run(options: argparse.Namespace) -> None:
    """Render; a scheduler is told of it where it wants to be."""
    with openjd.lines(options, f"rendering {options.output}"):
        _render(options)


def _render(options: argparse.Namespace) -> None:
    """Read, render, write; whatever can be refused is refused before the rendering."""
    if options.preview == options.output:
        raise UsageError(f"-o and --preview both name {options.output}; give the picture another name")
    for target in filter(None, (options.output, options.preview)):
        files.check_writable(target)
    scene, arrays = read_scene(options)
    begin = time.perf_counter()
    with progress(f"rendering {_name(options.scene)}"), connect(options) as client:
        rendering = client.render(
            scene, arrays=arrays, precision=options.precision, frame=options.frame, band=options.band
        )
    seconds = time.perf_counter() - begin
    files.write(options.output, rendering.exr)
    written = [(options.output, rendering.exr)]
    if options.preview:
        picture = _picture(rendering)
        files.write(options.preview, picture)
        written.append((options.preview, picture))
    if options.verbose and sys.stderr is not None:
        print(_summary(options.scene, rendering, seconds, written), file=sys.stderr)


def _picture(rendering: "Rendering") -> bytes:
    from conicoid_client import exr, picture

    return picture.png(exr.decode(rendering.exr))


def _summary(scene: str, rendering: "Rendering", seconds: float, written: list[tuple[str, bytes]]) -> str:
    stages = ", ".join(f"{name} {ms:.1f}" for name, ms in rendering.timing_ms.items())
    lines = [f"{_name(scene)}: {seconds:.2f} s" + (f" ({stages} ms)" if stages else "")]
    return "\n".join(lines + [f"{_name(target)}: {len(data):,} bytes" for target, data in written])


def _name(path: str) -> str:
    return "standard stream" if path == files.STANDARD else path
