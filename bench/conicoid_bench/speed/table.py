"""Results as Markdown: times, then how wrong those are that we are compared with."""

import re
from collections.abc import Iterator
from typing import Any

from conicoid_bench.speed.race import RIGHT

_OURS = "Conicoid exact"


def markdown(results: dict[str, Any]) -> str:
    """Both tables of one run, under what ran where."""
    return "\n".join([*_where(results), "", *_times(results), "", *_errors(results), "", *_growth(results), ""])


def driver(results: dict[str, Any]) -> str:
    """A short name of the OpenCL driver: PoCL with its version, else the platform."""
    found = re.search(r"PoCL \d+\.\d+", results["device"]["version"])
    return found[0] if found else str(results["device"]["platform"])


def fastest_right(scene: dict[str, Any]) -> str | None:
    """The name of the fastest peer whose picture is right."""
    rows = {name: row for name, row in scene["contenders"].items() if not name.startswith("Conicoid")}
    return min((name for name, row in rows.items() if row.get("right")), key=lambda n: rows[n]["ms"], default=None)


def _where(results: dict[str, Any]) -> Iterator[str]:
    versions = ", ".join(f"{name} {number}" for name, number in results["libraries"].items() if name != "conicoid")
    checked = min(scene["verified"]["pixels"] for scene in results["scenes"])
    yield (
        f"**{driver(results)}**, {results['processor']}, {results['device']['compute_units']} threads, load average "
        f"{results['load']:.1f} before it began, commit {results['commit']}, Python {results['python']}, {versions}. "
        f"`exact` was found right at {checked:,} pixels of each scene. Medians of up to {results['laps']} laps, ms:"
    )


def _times(results: dict[str, Any]) -> Iterator[str]:
    names = [name for name in _names(results) if any("ms" in s["contenders"][name] for s in results["scenes"])]
    yield _line(["scene", "write only", *names, "`exact` ÷ write only", "fastest right peer ÷ `exact`"])
    yield _line(["---", *["---:"] * (len(names) + 3)])
    for scene in results["scenes"]:
        ours, peer = scene["contenders"][_OURS]["ms"], fastest_right(scene)
        yield _line([
            scene["name"],
            _ms(scene["write_only_ms"]),
            *(_time(scene["contenders"][name]) for name in names),
            f"{ours / scene['write_only_ms']:.1f}",
            f"{scene['contenders'][peer]['ms'] / ours:.1f} ({peer})" if peer else "–",
        ])  # fmt: skip
    yield ""
    missing = "".join(f" {name} took no part: {why}." for name, why in results["missing"].items())
    yield f"Set-up or build + cast, `exact` is compared by the sum of both.{missing}"


def _errors(results: dict[str, Any]) -> Iterator[str]:
    names = [name for name in _names(results) if name != _OURS]
    yield (
        "Wrong hits + wrong ids, and the worst depth in float32 ulp where the right quadric is seen; "
        f"**not right** above 1 pixel in {1 / RIGHT:,.0f}. Of `exact`, which has neither: the pixels "
        "that double-double rounded + those that the host settled:"
    )
    yield ""
    yield _line(["scene", "hits", _OURS, *names])
    yield _line(["---", *["---:"] * (len(names) + 2)])
    for scene in results["scenes"]:
        pixels = scene["width"] * scene["height"]
        cells = (_error(scene["contenders"][name], pixels) for name in names)
        ours = scene["contenders"][_OURS]
        effort = f"{ours['refined']:,} + {ours['settled']:,}"
        yield _line([scene["name"], f"{scene['hits']:,}", effort, *cells])


def _growth(results: dict[str, Any]) -> Iterator[str]:
    yield "Growth of `exact` per doubling, between one measured value and the next:"
    yield ""
    yield _line(["of", "from", "to", "worst", "last"])
    yield _line(["---", *["---:"] * 4])
    for sweep in results["growth"]:
        steps = sweep["per_doubling"][_OURS]
        first, last = (sweep["points"][k]["label"] for k in (0, -1))
        yield _line([sweep["name"], first, last, f"{max(steps):.2f} ×", f"{steps[-1]:.2f} ×"])


def _names(results: dict[str, Any]) -> list[str]:
    return list(results["scenes"][0]["contenders"])


def _time(row: dict[str, Any]) -> str:
    return f"{_ms(row['build_ms'])} + {_ms(row['cast_ms'])}" if "ms" in row else "–"


def _error(row: dict[str, Any], pixels: int) -> str:
    if "not_measured" in row:
        return "–"
    ulp = "" if row["worst_ulp"] is None else f", {row['worst_ulp']:,} ulp"
    text = f"{row['wrong_hits']:,} + {row['wrong_ids']:,}{ulp}"
    return text if row["wrong_hits"] + row["wrong_ids"] <= RIGHT * pixels else f"**{text}**"


def _ms(value: float) -> str:
    return f"{value:.1f}" if value < 100 else f"{value:,.0f}"


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"
