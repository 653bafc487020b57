"""`conicoid bench`: measurements on this machine; what they need beyond Conicoid is its `bench` extra."""

import argparse
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from conicoid_client import files
from conicoid_client.command.report import Failure, UsageError

if TYPE_CHECKING:
    from conicoid_bench.scenes import BenchScene

_NEEDED = ("matplotlib", "mitsuba")


def run(options: argparse.Namespace) -> None:
    """Run the measurement that was asked for; `error` is the only one."""
    folder = Path(options.output)
    files.check_writable(str(folder / "error.json") if folder.is_dir() else str(folder))
    scenes = _scenes(options)
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise Failure(f"conicoid bench needs {' and '.join(missing)}; install with: pip install 'conicoid[bench]'")
    from conicoid.errors import DeviceError
    from conicoid_bench.error import run
    from conicoid_bench.files import write
    from conicoid_bench.truth import WrongTruth

    try:
        results = run(scenes, options.checked, _say)
    except (WrongTruth, DeviceError) as error:
        raise Failure(str(error)) from None
    for path in write(results, folder):
        files.say(str(path))


def _scenes(options: argparse.Namespace) -> list["BenchScene"]:
    from conicoid.errors import SceneError
    from conicoid_bench.scenes import built_in, from_file

    scenes = [] if options.only_given else list(built_in(options.scale))
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
