"""`conicoid bench error`: every renderer on every scene in one process, against the exact image."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from conicoid.device import find_device
from conicoid.engine import Renderer as Engine
from conicoid_bench.engine import Conicoid
from conicoid_bench.machine import machine
from conicoid_bench.measure import measured
from conicoid_bench.mitsuba_shapes import Mitsuba
from conicoid_bench.opencl import Textbook
from conicoid_bench.picture import Renderer
from conicoid_bench.scenes import BenchScene
from conicoid_bench.truth import truth
from conicoid_bench.vectorised import Vectorised

Results = dict[str, Any]


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
    exact, facts = truth(engine, bench, checked)
    rows: Results = {}
    for renderer in renderers:
        if reason := renderer.why_not(scene):
            rows[renderer.name] = {"not_measured": reason}
            continue
        rows[renderer.name] = measured(renderer, scene, exact)
        say(f"  {renderer.name}: {rows[renderer.name]['ms']:.3g} ms")
    return {**facts, "renderers": rows}
