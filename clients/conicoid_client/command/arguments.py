"""The arguments of every command."""

import argparse

from conicoid_client.command.bench_arguments import add_bench
from conicoid_client.command.job_arguments import add_jobs
from conicoid_client.command.numbers import pixels, port, samples
from conicoid_client.command.render_arguments import PRECISIONS, add_join, add_render, add_scene

_SAMPLES = 4000
_CONFIG = "settings; variables win (default: $CONICOID_CONFIG)"
_RUNNING_SERVER = "the service, as in http://127.0.0.1:8000 (default: $CONICOID_SERVER)"
_SERVER = "a running service, as in http://127.0.0.1:8000 (default: $CONICOID_SERVER, else this process)"


def parser() -> argparse.ArgumentParser:
    """The parser of `conicoid`."""
    whole = argparse.ArgumentParser(
        prog="conicoid",
        description="Exact batch ray-casting of quadrics: scene documents in, OpenEXR depth and normals out.",
        epilog="`-` is standard input or output. Exit status: 0 done; 2 bad usage or bad scene; 1 anything else.",
    )
    whole.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = whole.add_subparsers(dest="command", metavar="COMMAND", required=True)

    def command(name: str, summary: str) -> argparse.ArgumentParser:
        return commands.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")

    serve = command("serve", "answer HTTP requests until interrupted")
    serve.add_argument("--host", default="127.0.0.1", help="address to listen on (default: %(default)s)")
    serve.add_argument("--port", default=8000, type=port, help="port to listen on, 0 for any (default: %(default)s)")
    serve.add_argument("--config", metavar="FILE.toml", help=_CONFIG)

    _add_worker(command("worker", "render what the API of a farm sends, until interrupted"))

    add_render(command("render", "render a scene to an OpenEXR file"), _SERVER)
    add_join(command("join", "join the bands of a frame to its OpenEXR file"))

    submit = command("submit", "have a service render a batch of cameras, and fetch the frames as they end")
    add_scene(submit)
    submit.add_argument("-o", "--output", metavar="DIR", help="for frame-00000.exr and so on")
    submit.add_argument("--server", metavar="URL", help=_RUNNING_SERVER)
    submit.add_argument("--detach", action="store_true", help="print the job's id and do not wait")
    submit.add_argument(
        "--priority", choices=("normal", "high"), default="normal", help="high comes before your others"
    )
    submit.add_argument("--idempotency-key", metavar="KEY", help="the same key and scene again are the same job")

    add_jobs(command("jobs", "see, await, fetch and cancel jobs of a service"))

    verify = command("verify", "check a rendering of a scene against exact arithmetic, pixel by pixel")
    add_scene(verify)
    amount = verify.add_mutually_exclusive_group()
    amount.add_argument("--every-pixel", action="store_true", help="check all pixels, about a thousand a second")
    amount.add_argument(
        "--samples", type=samples, default=_SAMPLES, metavar="N",
        help="check N pixels, half of them on silhouettes (default: %(default)s)",
    )  # fmt: skip
    verify.add_argument("--precision", choices=PRECISIONS, help="in place of the scene's own")
    verify.add_argument("--server", metavar="URL", help=_SERVER)
    verify.add_argument("--json", action="store_true", help="as JSON")

    canonical = command("canonical", "print a scene with everything resolved and every default filled in")
    add_scene(canonical)
    canonical.add_argument("--server", metavar="URL", help=_SERVER)

    preview = command("preview", "make a picture of an OpenEXR file: depth beside normals")
    preview.add_argument("image", metavar="IN.exr")
    preview.add_argument("-o", "--output", required=True, metavar="OUT.png")
    preview.add_argument("--width", type=pixels, metavar="PIXELS", help="shrink the picture to this width")
    preview.add_argument("--background", metavar="COLOUR", help="as in white or #15171c (default: transparent)")

    info = command("info", "describe an OpenEXR file")
    info.add_argument("image", metavar="IN.exr")
    info.add_argument("--json", action="store_true", help="as JSON")

    device = command("device", "list the OpenCL devices here, or the device of a service")
    device.add_argument(
        "--server", metavar="URL", help="a running service (default: $CONICOID_SERVER, else this machine)"
    )
    device.add_argument("--json", action="store_true", help="as JSON")

    add_bench(command("bench", "measure on this machine"))
    return whole


def _add_worker(worker: argparse.ArgumentParser) -> None:
    worker.add_argument(
        "--processes",
        type=samples,
        metavar="N",
        help="units rendered at a time (default: $CONICOID_RENDER_PROCESSES or 1)",
    )
    worker.add_argument("--queues", default="high,normal", metavar="NAMES", help="(default: %(default)s)")
    worker.add_argument("--once", action="store_true", help="render one unit, if there is one, and end")
    worker.add_argument("--config", metavar="FILE.toml", help=_CONFIG)


class _Version(argparse.Action):
    """Looks the version up only when it is asked for: that takes longer than everything else here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"conicoid {version('conicoid')}")
        parser.exit()
