"""All of `conicoid bench speed`: scenes, then growth."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from conicoid.engine import Renderer as Engine
from conicoid_bench.machine import machine
from conicoid_bench.scenes import BenchScene
from conicoid_bench.speed.contenders import Contender, contenders
from conicoid_bench.speed.floor import WriteOnly
from conicoid_bench.speed.growth import Sweep, per_doubling
from conicoid_bench.speed.race import Check, all_errors, pixels_only, race
from conicoid_bench.truth import truth

Results = dict[str, Any]
# Beside Conicoid, who takes part in growth: the others are too slow, or have nothing to say about it.
_GROWING: Final = ("Conicoid exact", "numba", "Embree")


@dataclass(frozen=True)
class Effort:
    """How much is measured.

    Attributes:
        laps: of each contender on each scene.
        enough_s: seconds after which a slow one takes no more.
        checked: pixels per scene where `exact` is first checked against exact arithmetic.
    """

    laps: int
    enough_s: float
    checked: int


FULL: Final = Effort(15, 4.0, 4000)
QUICK: Final = Effort(5, 0.5, 400)


class Speed:
    """A device, and all who run beside it.

    Args:
        device: as CONICOID_DEVICE; None reads it.
        embree: the built program of bench/embree, which need not be there.
        say: told of each scene and contender when it is done.
    """

    def __init__(self, device: str | None, embree: Path, effort: Effort, say: Callable[[str], object]) -> None:
        self._device, self._effort, self._say = device, effort, say
        self._engine = Engine(device)
        self._machine = machine(self._engine)
        self._contenders, self._missing = contenders(self._engine, embree)

    def run(self, scenes: Iterable[BenchScene], sweeps: Iterable[Sweep]) -> Results:
        """Measure.

        Returns:
            Plain values for JSON: machine, scenes, growth.
        Raises:
            WrongTruth: `exact` differs from exact arithmetic.
        """
        results: Results = {**self._machine, "laps": self._effort.laps, "missing": self._missing}
        results["scenes"] = [self._scene(scene, self._contenders, all_errors) for scene in scenes]
        results["growth"] = [self._sweep(sweep) for sweep in sweeps]
        return results

    def _sweep(self, sweep: Sweep) -> Results:
        growing = [contender for contender in self._contenders if contender.name in _GROWING]
        points = []
        for value in sweep.values:
            label = sweep.label(value)
            scene = BenchScene(f"{sweep.name} {label}", sweep.axis, sweep.scene(value))
            points.append({"at": value, "label": label, **self._scene(scene, growing, pixels_only)})
        times: dict[str, list[float]] = {
            c.name: [point["contenders"][c.name]["ms"] for point in points] for c in growing
        }
        doubling = {name: per_doubling(sweep.values, ms) for name, ms in times.items()}
        return {"name": sweep.name, "axis": sweep.axis, "points": points, "per_doubling": doubling}

    def _scene(self, bench: BenchScene, taking_part: Sequence[Contender], check: Check) -> Results:
        self._say(bench.name)
        scene, effort = bench.scene, self._effort
        exact, facts = truth(self._engine, bench, effort.checked)
        floor = WriteOnly(self._device, *exact.depth.shape)
        floor_ms, rows = race(taking_part, floor.lap, scene, exact, check, effort.laps, effort.enough_s)
        for name, row in rows.items():
            if "ms" in row:
                self._say(f"  {name}: {row['build_ms']:.3g} + {row['cast_ms']:.3g} ms")
        return {**facts, "write_only_ms": floor_ms, "contenders": rows}
