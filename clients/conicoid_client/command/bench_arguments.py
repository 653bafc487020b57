"""The arguments of `conicoid bench`."""

import argparse

from conicoid_client.command.numbers import samples, scale

_SAMPLES = 4000


def add_bench(bench: argparse.ArgumentParser) -> None:
    """Add one for each measurement."""
    measurements = bench.add_subparsers(dest="measurement", metavar="MEASUREMENT", required=True)
    summary = "run time against error, beside other ways to render quadrics"
    error = measurements.add_parser("error", help=summary, description=summary[0].upper() + summary[1:] + ".")
    error.add_argument("scenes", metavar="SCENE.json", nargs="*", help="scenes to measure after the built-in ones")
    error.add_argument("-o", "--output", required=True, metavar="DIR", help="for error.json, .md, .png and .svg")
    error.add_argument("--only-given", action="store_true", help="leave out the built-in scenes")
    error.add_argument(
        "--scale", type=scale, default=1.0, metavar="S", help="of the built-in images' 1920 x 1080 (default: 1)"
    )
    error.add_argument(
        "--checked", type=samples, default=_SAMPLES, metavar="N",
        help="pixels per scene where `exact` is first checked against exact arithmetic (default: %(default)s)",
    )  # fmt: skip

    summary = "run time and how it grows, beside other ways to render quadrics and a kernel that only writes"
    speed = measurements.add_parser("speed", help=summary, description=summary[0].upper() + summary[1:] + ".")
    speed.add_argument("scenes", metavar="SCENE.json", nargs="*", help="scenes to measure after the built-in ones")
    speed.add_argument("-o", "--output", required=True, metavar="DIR", help="for speed-*.json, .md, .png, .svg ...")
    speed.add_argument("--device", metavar="NAME", help='as in "PoCL 3.1" (default: $CONICOID_DEVICE, else any)')
    speed.add_argument("--quick", action="store_true", help="fewer and smaller scenes and laps: under two minutes")
    speed.add_argument(
        "--most-quadrics", type=samples, default=10**6, metavar="N", help="where growth ends (default: %(default)s)"
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
