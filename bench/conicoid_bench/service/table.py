"""Results as Markdown."""

from collections.abc import Iterator
from typing import Any

from conicoid_bench.speed.table import driver

_STAGES = ("queue", "parse", "setup", "cast", "encode")


def markdown(results: dict[str, Any]) -> str:
    """The tables of one run, under what ran where."""
    return "\n".join([*_where(results), "", *_once(results), "", *_compressions(results), ""])


def _where(results: dict[str, Any]) -> Iterator[str]:
    yield (
        f"**{driver(results)}**, {results['processor']}, {results['threads']} threads, load average "
        f"{results['load']:.1f} before it began, commit {results['commit']}. {results['quadrics']:,} quadrics, a "
        f"document of {results['document_bytes']:,} bytes, {results['width']} × {results['height']}, "
        f"{' and '.join(results['channels'])}: {results['image_bytes']:,} bytes, which a plain copy takes "
        f"{results['copy_ms']:.1f} ms for. Medians, ms:"
    )


def _once(results: dict[str, Any]) -> Iterator[str]:
    zipped = results["compressions"]["zip"]
    yield _line(["what", "ms", "bar"])
    yield _line(["---", "---:", "---:"])
    yield _line(["a new scene, `zip`, without OpenEXR's own time", f"{zipped['rest_ms']:.1f}", "25"])
    yield _line(["the same request, 304", f"{results['not_modified_ms']:.1f}", "5"])
    yield _line(["the same request, the image again", f"{results['cached_ms']:.1f}", "30"])
    yield _line(
        ["`conicoid serve` to the end of the first frame, kernels cached", f"{results['start_ms']:,.0f}", "1,500"]
    )


def _compressions(results: dict[str, Any]) -> Iterator[str]:
    rate = f"frames/s, {results['clients']} clients"
    yield _line(["compression", "bytes", "HTTP to HTTP", "OpenEXR alone", "rest", *_STAGES, "MB/s", rate])
    yield _line(["---", *["---:"] * (len(_STAGES) + 6)])
    for name, row in results["compressions"].items():
        stages = (f"{row['stages_ms'][stage]:.1f}" for stage in _STAGES)
        speed = 1e-3 * results["image_bytes"] / row["ms"]
        times = (f"{row[key]:.1f}" for key in ("ms", "openexr_ms", "rest_ms"))
        yield _line([f"`{name}`", f"{row['bytes']:,}", *times, *stages, f"{speed:.0f}", f"{row['frames_per_s']:.1f}"])


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"
