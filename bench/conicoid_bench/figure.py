"""Results as a picture: run time against error, one column per scene, PNG and SVG."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from conicoid_bench.drawing import GRID, figure, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito's colours, which colour-blind people tell apart; the shape says the same once more: a star and
# triangles are Conicoid, circles float32, squares float64.
_STYLE: Final = {
    "conicoid exact": ("#000000", "*", "Conicoid exact"),
    "conicoid float64": ("#0072B2", "^", "Conicoid float64"),
    "conicoid float32": ("#56B4E9", "v", "Conicoid float32"),
    "textbook float32": ("#D55E00", "o", "textbook float32"),
    "textbook float64": ("#E69F00", "s", "textbook float64"),
    "Kahan float64": ("#CC79A7", "s", "Kahan's discriminant float64"),
    "NumPy float64": ("#999999", "s", "NumPy float64"),
    "Mitsuba sphere": ("#009E73", "o", "Mitsuba 3 sphere (float32)"),
    "Mitsuba ellipsoids": ("#009E73", "D", "Mitsuba 3 ellipsoids"),
}
SHOWN: Final = ("sphere near", "sphere at 1e6", "sphere at 1e8", "100,000 ellipsoids", "lysozyme")
_PER_MILLION: Final = {0: "0", 1: "1", 1e2: "100", 1e4: "10⁴", 1e6: "10⁶"}
_ULP: Final = {0: "0", 1: "1", 1e2: "100", 1e4: "10⁴", 1e6: "10⁶", 1e8: "no pixel\nright"}
_NOWHERE: Final = max(_ULP)


def draw(results: dict[str, Any], stem: Path) -> list[Path]:
    """Write STEM.png and STEM.svg of the shown scenes that were measured; the paths."""
    scenes = [scene for name in SHOWN for scene in results["scenes"] if scene["name"] == name] or results["scenes"][:5]
    width = 2.5 * len(scenes) + 0.9
    with figure(width, 5.9) as drawn:
        axes = drawn.subplots(2, len(scenes), sharex="col", sharey="row", squeeze=False)
        for column, scene in enumerate(scenes):
            _panel(axes[0, column], scene, _wrong_share, _PER_MILLION)
            _panel(axes[1, column], scene, _depth_errors, _ULP)
            axes[0, column].set_title(scene["name"], fontsize=10)
            axes[1, column].set_xlabel("ms per frame")
        axes[0, 0].set_ylabel("wrong pixels\nper million hits")
        axes[1, 0].set_ylabel("depth error in float32 ulp\n(mark: worst, tail: median)")
        handles, labels = _legend(axes[0].tolist())
        drawn.legend(handles, labels, loc="outside lower center", ncols=max(1, int(width / 2.6)), frameon=False)
        return save(drawn, stem)


def _panel(axes: "Axes", scene: dict[str, Any], errors: Any, levels: dict[float, str]) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=1, linscale=0.6)
    axes.set_yticks(list(levels), list(levels.values()))
    axes.axhspan(-0.5, 0.4, color="#F0E442", alpha=0.35, linewidth=0)
    axes.grid(visible=True, **GRID)
    axes.set_axisbelow(True)
    for name, (colour, marker, label) in _STYLE.items():
        row = scene["renderers"].get(name, {})
        if "ms" not in row:
            continue
        worst, median = errors(row, scene)
        size = {"*": 15, "^": 8, "v": 8}.get(marker, 7)
        axes.plot([row["ms"], row["ms"]], [median, worst], color=colour, linewidth=1.4, zorder=2)
        axes.plot([row["ms"]], [worst], marker=marker, color=colour, markersize=size, linestyle="none", label=label,
                  markeredgecolor="white", markeredgewidth=0.7, zorder=4 if marker == "*" else 3)  # fmt: skip
    axes.set_ylim(-0.5, 4 * max(levels))
    axes.margins(x=0.15)
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 3), numticks=12))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _wrong_share(row: dict[str, Any], scene: dict[str, Any]) -> tuple[float, float]:
    share = 1e6 * (row["wrong_hits"] + row["wrong_ids"]) / scene["hits"]
    return share, share


def _depth_errors(row: dict[str, Any], _: dict[str, Any]) -> tuple[float, float]:
    if row["worst_ulp"] is None:
        return _NOWHERE, _NOWHERE
    return row["worst_ulp"], row["median_ulp"]


def _legend(axes: Sequence["Axes"]) -> tuple[list[Any], list[str]]:
    found: dict[str, Any] = {}
    for one in axes:
        handles, labels = one.get_legend_handles_labels()
        found |= dict(zip(labels, handles, strict=True))
    order = [label for _, _, label in _STYLE.values() if label in found]
    return [found[label] for label in order], order
