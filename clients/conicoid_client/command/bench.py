"""`conicoid bench`: measurements on this machine; what they need beyond Conicoid is its `bench` extra."""

import argparse
import sys
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from conicoid_client import files
from conicoid_client.command.report import Failure, UsageError

if TYPE_CHECKING:
    from conicoid_bench.scenes import BenchScene

_NEEDED = {"error": ("matplotlib", "mitsuba"), "speed": ("matplotlib", "mitsuba", "numba"), "service": ()}


def run(options: argparse.Namespace) -> None:
    """Run the measurement that was asked for, `error`, `speed` or `service`."""
    folder = Path(options.output)
    files.check_writable(str(folder / f"{options.measurement}.json") if folder.is_dir() else str(folder))
    measured = _measurement(options)
    missing = [name for name in _NEEDED[options.measurement] if find_spec(name) is None]
    if missing:
        raise Failure(f"conicoid bench needs {' and '.join(missing)}; install with: pip install 'conicoid[bench]'")
    from conicoid.errors import DeviceError
    from conicoid_bench.embree import PeerFailed
    from conicoid_bench.service.server import ServiceFailed
    from conicoid_bench.truth import WrongTruth

    try:
        paths = measured(folder)
    except (WrongTruth, PeerFailed, ServiceFailed, DeviceError) as error:
        raise Failure(str(error)) from None
    for path in paths:
        files.say(str(path))


def _measurement(options: argparse.Namespace) -> Callable[[Path], list[Path]]:
    """What was asked for, with the scenes that it needs, which have been read."""
    if options.measurement == "service":
        return partial(_service, options, files.read(options.scene))
    return partial(_error if options.measurement == "error" else _speed, options, _scenes(options))


def _service(options: argparse.Namespace, document: bytes, folder: Path) -> list[Path]:
    from conicoid.errors import SceneError
    from conicoid_bench.service.files import write
    from conicoid_bench.service.run import run

    try:
        return write(run(document, options.device, _say), folder)
    except SceneError as error:
        raise UsageError(f"{options.scene}: {error}") from None


def _error(options: argparse.Namespace, scenes: list["BenchScene"], folder: Path) -> list[Path]:
    from conicoid_bench.error import run
    from conicoid_bench.files import write

    return write(run(scenes, options.checked, _say), folder)


def _speed(options: argparse.Namespace, scenes: list["BenchScene"], folder: Path) -> list[Path]:
    from conicoid_bench.speed.files import write
    from conicoid_bench.speed.growth import sweeps
    from conicoid_bench.speed.run import FULL, QUICK, Speed

    speed = Speed(options.device, Path(options.embree), QUICK if options.quick else FULL, _say)
    return write(speed.run(scenes, sweeps(options.quick, options.most_quadrics)), folder)


def _scenes(options: argparse.Namespace) -> list["BenchScene"]:
    from conicoid.errors import SceneError
    from conicoid_bench import scenes as of_error
    from conicoid_bench.scenes import from_file
    from conicoid_bench.speed import scenes as of_speed

    if options.measurement == "speed":
        scenes = list(of_speed.built_in(options.quick))
    else:
        scenes = [] if options.only_given else list(of_error.built_in(options.scale))
    for path in options.scenes:
        try:
            scenes.append(from_file(Path(path)))
        except SceneError as error:
            raise UsageError(f"{path}: {error}") from None
    if not scenes:
        raise UsageError("nothing to measure; name a SCENE.json, or leave out --only-given")
    return scenes


def _say(text: str) -> None:
    if sys.stderr is not None:
        print(text, file=sys.stderr, flush=True)
