"""Results as pictures: times of all contenders on every scene, and growth."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from conicoid_bench.drawing import GRID, figure, save
from conicoid_bench.speed.table import driver

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

# Okabe and Ito's colours, which colour-blind people tell apart; the shape says the same once more.
_STYLE: Final = {
    "Conicoid exact": ("#000000", "*"),
    "Conicoid float64": ("#0072B2", "^"),
    "Conicoid float32": ("#56B4E9", "v"),
    "NumPy float64": ("#999999", "s"),
    "numba": ("#E69F00", "o"),
    "Mitsuba sphere": ("#009E73", "D"),
    "Embree": ("#D55E00", "P"),
}
_FLOOR: Final = "#CC79A7"


def draw_scenes(results: dict[str, Any], stem: Path) -> list[Path]:
    """Write STEM.png and STEM.svg: a row per scene, a mark per contender; the paths."""
    scenes = results["scenes"]
    with figure(9.5, 0.55 * len(scenes) + 1.4) as drawn:
        axes = drawn.subplots()
        floors = [scene["write_only_ms"] for scene in scenes]
        axes.plot(floors, range(len(scenes)), "|", color=_FLOOR, markersize=13, markeredgewidth=3, label="write only")
        for name, (colour, marker) in _STYLE.items():
            places = [k for k, scene in enumerate(scenes) if "ms" in scene["contenders"].get(name, {})]
            if places:
                times = [scenes[k]["contenders"][name]["ms"] for k in places]
                size, level = (15, 4) if marker == "*" else (8, 3)
                axes.plot(times, places, marker, color=colour, label=name, markeredgecolor="white",
                          markeredgewidth=0.7, markersize=size, zorder=level)  # fmt: skip
        axes.set_xscale("log")
        axes.set_yticks(range(len(scenes)), [scene["name"] for scene in scenes])
        axes.set_ylim(len(scenes) - 0.5, -0.5)
        axes.grid(visible=True, **GRID)
        axes.set_axisbelow(True)
        axes.set_xlabel(f"ms, set-up or build and cast; 1920 × 1080, Z and N, {driver(results)}")
        _plain_numbers(axes.xaxis)
        drawn.legend(loc="outside lower center", ncols=4, frameon=False)
        return save(drawn, stem)


def draw_growth(results: dict[str, Any], stem: Path) -> list[Path]:
    """Write STEM.png and STEM.svg: a panel per quantity; the paths."""
    sweeps = results["growth"]
    with figure(9.5, 3.4 * -(-len(sweeps) // 2) + 0.6) as drawn:
        panels = drawn.subplots(-(-len(sweeps) // 2), 2, squeeze=False).ravel().tolist()
        for axes, sweep in zip(panels, sweeps, strict=False):
            _panel(axes, sweep)
        for empty in panels[len(sweeps) :]:
            empty.remove()
        drawn.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)
        return save(drawn, stem)


def _panel(axes: "Axes", sweep: dict[str, Any]) -> None:
    points = sweep["points"]
    values = [point["at"] for point in points]
    axes.plot(values, [point["write_only_ms"] for point in points], "-|", color=_FLOOR, label="write only")
    for name, (colour, marker) in _STYLE.items():
        if name not in sweep["per_doubling"]:
            continue
        rows = [point["contenders"][name] for point in points]
        size = 11 if marker == "*" else 6
        axes.plot(values, [row["ms"] for row in rows], "-", marker=marker, color=colour, label=name, markersize=size,
                  markeredgecolor="white", markeredgewidth=0.6)  # fmt: skip
        if name.startswith("Conicoid"):
            axes.plot(values, [row["build_ms"] for row in rows], ":", color=colour, label="its set-up")
    axes.set_xscale("log")
    axes.minorticks_off()
    axes.set_xticks(values, [point["label"] for point in points])
    axes.set_yscale("log")
    _plain_numbers(axes.yaxis)
    axes.set_xlabel(sweep["axis"])
    axes.set_ylabel("ms")
    axes.grid(visible=True, **GRID)
    axes.set_axisbelow(True)


def _plain_numbers(axis: "Axis") -> None:
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    axis.set_major_locator(LogLocator(subs=(1, 3), numticks=20))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())
