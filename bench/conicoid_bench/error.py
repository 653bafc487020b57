"""`conicoid bench error`: every renderer on every scene in one process, against the exact image."""

import platform
import subprocess
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, replace
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import numpy as np

from conicoid.device import find_device
from conicoid.engine import Renderer as Engine
from conicoid.verify import check, sampled_places, silhouettes
from conicoid_bench.engine import Conicoid
from conicoid_bench.measure import measured
from conicoid_bench.mitsuba_shapes import Mitsuba
from conicoid_bench.opencl import Textbook
from conicoid_bench.picture import Picture, Renderer
from conicoid_bench.scenes import BenchScene
from conicoid_bench.vectorised import Vectorised

Results = dict[str, Any]
_LIBRARIES: Final = ("conicoid", "numpy", "pyopencl", "mitsuba", "drjit")


class WrongTruth(Exception):
    """`exact` is not exact here, so that nothing can be measured against it."""


def run(scenes: Iterable[BenchScene], checked: int, say: Callable[[str], object]) -> Results:
    """Measure.

    Args:
        scenes: what to render.
        checked: pixels per scene where `exact` is first checked against exact arithmetic.
        say: told of each scene and renderer when it is done.
    Returns:
        Plain values for JSON: machine, scenes, and under each scene its renderers.
    Raises:
        WrongTruth: `exact` differs from exact arithmetic.
    """
    engine = Engine()
    renderers, missing = _renderers(engine)
    results: Results = {**machine(engine), "missing": missing, "scenes": []}
    for scene in scenes:
        say(scene.name)
        results["scenes"].append(_scene(engine, renderers, scene, checked, say))
    return results


def _renderers(engine: Engine) -> tuple[list[Renderer], dict[str, str]]:
    device = find_device()
    renderers: list[Renderer] = [
        Conicoid(engine, "float32"), Conicoid(engine, "float64"), Conicoid(engine, "exact"),
        Textbook(device, "textbook float32"), Textbook(device, "textbook float64"), Textbook(device, "Kahan float64"),
        Vectorised(),
    ]  # fmt: skip
    try:
        renderers += [Mitsuba("sphere"), Mitsuba("ellipsoids")]
    except ImportError as error:
        return renderers, {"Mitsuba": str(error)}
    return renderers, {}


def _scene(
    engine: Engine, renderers: Sequence[Renderer], bench: BenchScene, checked: int, say: Callable[[str], object]
) -> Results:
    scene = bench.scene
    exact, verdict = truth(engine, bench, checked)
    rows: Results = {}
    for renderer in renderers:
        if reason := renderer.why_not(scene):
            rows[renderer.name] = {"not_measured": reason}
            continue
        rows[renderer.name] = measured(renderer, scene, exact)
        say(f"  {renderer.name}: {rows[renderer.name]['ms']:.3g} ms")
    return {
        "name": bench.name,
        "reason": bench.reason,
        "quadrics": len(scene.quadrics),
        "width": scene.camera.width,
        "height": scene.camera.height,
        "hits": int(np.count_nonzero(exact.id)),
        "verified": verdict,
        "renderers": rows,
    }


def truth(engine: Engine, bench: BenchScene, checked: int) -> tuple[Picture, dict[str, int]]:
    """The exact picture, after pixels of it were checked against exact arithmetic; and how many were.

    Raises:
        WrongTruth: one was not right.
    """
    job = Conicoid(engine, "exact").prepare(bench.scene)
    picture = job.picture(job.run())
    planes = {"Z": picture.depth, "id": picture.id}
    planes |= {f"N.{axis}": picture.normal[..., k] for k, axis in enumerate("XYZ")}
    places = sampled_places(planes, checked)
    output = replace(bench.scene.output, normal_space="world", normal_side="facing", background_depth=np.inf)
    verdict = check(replace(bench.scene, output=output), planes, bench.scene.camera.crop, places)
    if verdict.wrong:
        raise WrongTruth(f"{bench.name}: `exact` is wrong at {verdict.wrong} pixels; {verdict.differences[0]}")
    edge = silhouettes(planes)[tuple(places.T)]
    return picture, {"pixels": verdict.pixels, "silhouette": int(edge.sum()), "hits": verdict.hits}


def machine(engine: Engine) -> Results:
    """What ran where."""
    return {
        "commit": _commit(),
        "device": asdict(engine.device),
        "processor": _processor(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "libraries": {name: found for name in _LIBRARIES if (found := _version(name))},
    }


def _version(name: str) -> str | None:
    try:
        return version(name)
    except ImportError:
        return None


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")


def _commit() -> str | None:
    """The checkout's commit, with + where files differ from it; None where this is not one."""
    here = str(files("conicoid_bench"))
    command = ["git", "-C", here, "describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() or None
