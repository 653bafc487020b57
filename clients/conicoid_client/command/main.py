"""Arguments in, exit status out: 0 done; 2 bad usage or bad scene; 1 anything else."""

import argparse
import os
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import NoReturn

from conicoid_client.command.report import report

DONE, FAILED, BAD_INPUT, INTERRUPTED, TERMINATED = 0, 1, 2, 128 + signal.SIGINT, 128 + signal.SIGTERM

_PRECISIONS = ("exact", "float64", "float32")
_SAMPLES = 4000
_SERVER = "a running service, as in http://127.0.0.1:8000 (default: $CONICOID_SERVER, else this process)"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; never raises, so never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    signal.signal(signal.SIGTERM, _terminate)
    try:
        try:
            _run(arguments)
        finally:
            _deliver()
    except BrokenPipeError:
        return FAILED  # whoever read our output has gone; there is nobody to tell
    except KeyboardInterrupt:
        return INTERRUPTED
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else FAILED
    except Exception as error:  # noqa: BLE001 -- a traceback is a defect, whatever happened
        return BAD_INPUT if report(error) else FAILED
    return DONE


def _run(arguments: Sequence[str] | None) -> None:
    options = _parser().parse_args(arguments)
    run: Callable[[argparse.Namespace], None] = import_module(f"conicoid_client.command.{options.command}").run
    run(options)


def _deliver() -> None:
    """Flush standard output; what it does not take is dropped, or the interpreter would complain of it at its end."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise


def _terminate(_signal: int, _frame: object) -> NoReturn:
    raise SystemExit(TERMINATED)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="conicoid",
        description="Exact batch ray-casting of quadrics: scene documents in, OpenEXR depth and normals out.",
        epilog="`-` is standard input or output. Exit status: 0 done; 2 bad usage or bad scene; 1 anything else.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)

    def add_scene(command: argparse.ArgumentParser) -> None:
        command.add_argument("scene", metavar="SCENE.json")
        command.add_argument("--arrays", metavar="FILE.npz", help='the arrays that the scene names as "@name"')

    def command(name: str, summary: str) -> argparse.ArgumentParser:
        return commands.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")

    serve = command("serve", "answer HTTP requests until interrupted")
    serve.add_argument("--host", default="127.0.0.1", help="address to listen on (default: %(default)s)")
    serve.add_argument("--port", default=8000, type=_port, help="port to listen on, 0 for any (default: %(default)s)")
    serve.add_argument("--config", metavar="FILE.toml", help="settings; variables win (default: $CONICOID_CONFIG)")

    render = command("render", "render a scene to an OpenEXR file")
    add_scene(render)
    render.add_argument("-o", "--output", required=True, metavar="OUT.exr")
    render.add_argument("--preview", metavar="OUT.png", help="also write a picture: depth beside normals")
    render.add_argument("--precision", choices=_PRECISIONS, help="in place of the scene's own")
    render.add_argument("--server", metavar="URL", help=_SERVER)
    render.add_argument("-v", "--verbose", action="store_true", help="say what was written and how long it took")

    verify = command("verify", "check a rendering of a scene against exact arithmetic, pixel by pixel")
    add_scene(verify)
    amount = verify.add_mutually_exclusive_group()
    amount.add_argument("--every-pixel", action="store_true", help="check all pixels, about a thousand a second")
    amount.add_argument(
        "--samples", type=_samples, default=_SAMPLES, metavar="N",
        help="check N pixels, half of them on silhouettes (default: %(default)s)",
    )  # fmt: skip
    verify.add_argument("--precision", choices=_PRECISIONS, help="in place of the scene's own")
    verify.add_argument("--server", metavar="URL", help=_SERVER)
    verify.add_argument("--json", action="store_true", help="as JSON")

    canonical = command("canonical", "print a scene with everything resolved and every default filled in")
    add_scene(canonical)
    canonical.add_argument("--server", metavar="URL", help=_SERVER)

    preview = command("preview", "make a picture of an OpenEXR file: depth beside normals")
    preview.add_argument("image", metavar="IN.exr")
    preview.add_argument("-o", "--output", required=True, metavar="OUT.png")
    preview.add_argument("--width", type=_pixels, metavar="PIXELS", help="shrink the picture to this width")
    preview.add_argument("--background", metavar="COLOUR", help="as in white or #15171c (default: transparent)")

    info = command("info", "describe an OpenEXR file")
    info.add_argument("image", metavar="IN.exr")
    info.add_argument("--json", action="store_true", help="as JSON")

    device = command("device", "list the OpenCL devices here, or the device of a service")
    device.add_argument(
        "--server", metavar="URL", help="a running service (default: $CONICOID_SERVER, else this machine)"
    )
    device.add_argument("--json", action="store_true", help="as JSON")

    _add_bench(command("bench", "measure on this machine"))
    return parser


def _add_bench(bench: argparse.ArgumentParser) -> None:
    measurements = bench.add_subparsers(dest="measurement", metavar="MEASUREMENT", required=True)
    summary = "run time against error, beside other ways to render quadrics"
    error = measurements.add_parser("error", help=summary, description=summary[0].upper() + summary[1:] + ".")
    error.add_argument("scenes", metavar="SCENE.json", nargs="*", help="scenes to measure after the built-in ones")
    error.add_argument("-o", "--output", required=True, metavar="DIR", help="for error.json, .md, .png and .svg")
    error.add_argument("--only-given", action="store_true", help="leave out the built-in scenes")
    error.add_argument(
        "--scale", type=_scale, default=1.0, metavar="S", help="of the built-in images' 1920 x 1080 (default: 1)"
    )
    error.add_argument(
        "--checked", type=_samples, default=_SAMPLES, metavar="N",
        help="pixels per scene where `exact` is first checked against exact arithmetic (default: %(default)s)",
    )  # fmt: skip

    summary = "run time and how it grows, beside other ways to render quadrics and a kernel that only writes"
    speed = measurements.add_parser("speed", help=summary, description=summary[0].upper() + summary[1:] + ".")
    speed.add_argument("scenes", metavar="SCENE.json", nargs="*", help="scenes to measure after the built-in ones")
    speed.add_argument("-o", "--output", required=True, metavar="DIR", help="for speed-*.json, .md, .png, .svg ...")
    speed.add_argument("--device", metavar="NAME", help='as in "PoCL 3.1" (default: $CONICOID_DEVICE, else any)')
    speed.add_argument("--quick", action="store_true", help="fewer and smaller scenes and laps: under two minutes")
    speed.add_argument(
        "--most-quadrics", type=_samples, default=10**6, metavar="N", help="where growth ends (default: %(default)s)"
    )
    speed.add_argument(
        "--embree", default="build/embree_ellipsoids", metavar="PROGRAM",
        help="what `make embree` builds from bench/embree; without it the rest is measured (default: %(default)s)",
    )  # fmt: skip

    summary = "the service from request to answer: every compression, the same request again, its start"
    service = measurements.add_parser("service", help=summary, description=summary[0].upper() + summary[1:] + ".")
    service.add_argument("scene", metavar="SCENE.json", help="a scene that needs no arrays")
    service.add_argument("-o", "--output", required=True, metavar="DIR", help="for service-*.json and .md")
    service.add_argument("--device", metavar="NAME", help='as in "PoCL 3.1" (default: $CONICOID_DEVICE, else any)')


class _Version(argparse.Action):
    """Looks the version up only when it is asked for: that takes longer than everything else here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"conicoid {version('conicoid')}")
        parser.exit()


def _port(text: str) -> int:
    return _whole(text, 0, 65535)


def _pixels(text: str) -> int:
    return _whole(text, 1, 1 << 20)


def _scale(text: str) -> float:
    try:
        scale = float(text)
    except ValueError:
        scale = 0.0
    if not 0.01 <= scale <= 4:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0.01 to 4")
    return scale


def _samples(text: str) -> int:
    return _whole(text, 1, 1 << 28)


def _whole(text: str, least: int, most: int) -> int:
    if not text.isdecimal() or not least <= int(text) <= most:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} to {most}")
    return int(text)
