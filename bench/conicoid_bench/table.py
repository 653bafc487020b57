"""Results as a Markdown table."""

from collections.abc import Iterator
from typing import Any

_HEAD = (
    "| renderer | wrong hits | wrong ids | depth, worst ulp | median ulp | normal, worst ° | ms | once | escalated |",
    "|---|---:|---:|---:|---:|---:|---:|---:|---:|",
)


def markdown(results: dict[str, Any]) -> str:
    """One table per scene, under a heading each."""
    return "\n".join(line for scene in results["scenes"] for line in _scene(scene))


def _scene(scene: dict[str, Any]) -> Iterator[str]:
    pixels = scene["width"] * scene["height"]
    verified = scene["verified"]
    yield f"### {scene['name']}"
    yield ""
    yield (
        f"{scene['quadrics']:,} quadric{'s' if scene['quadrics'] > 1 else ''}, {scene['width']} × {scene['height']}, "
        f"{scene['hits']:,} hits; {scene['reason']}. "
        f"Truth checked at {verified['pixels']:,} pixels, {verified['silhouette']:,} of them on silhouettes."
    )
    yield ""
    yield from _HEAD
    left_out = []
    for name, row in scene["renderers"].items():
        if "not_measured" in row:
            left_out.append(f"{name} ({row['not_measured']})")
        else:
            yield _row(name, row, pixels)
    yield ""
    if left_out:
        yield f"Left out: {', '.join(left_out)}."
        yield ""


def _row(name: str, row: dict[str, Any], pixels: int) -> str:
    cells = [
        name,
        f"{row['wrong_hits']:,}",
        f"{row['wrong_ids']:,}",
        _count(row["worst_ulp"]),
        _count(row["median_ulp"]),
        _degrees(row["worst_degrees"]),
        _ms(row["ms"]),
        _ms(row["prepare_ms"]),
        f"{_share(row['refined'], pixels)}, {_share(row['settled'], pixels)}",
    ]
    return f"| {' | '.join(cells)} |"


def _share(count: int, pixels: int) -> str:
    return f"{count:,}" + (f" ({1e6 * count / pixels:.2g} ppm)" if count else "")


def _count(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:,.0f}" if value < 1e6 else f"{value:.1e}"


def _degrees(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def _ms(value: float) -> str:
    return f"{value:.2g}" if value < 10 else f"{value:,.0f}"
