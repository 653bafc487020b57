"""Figures that are the same file for the same results: no date, fixed ids."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GRID: Final[dict[str, Any]] = {"color": "#dddddd", "linewidth": 0.6}


@contextmanager
def figure(width: float, height: float) -> Iterator["Figure"]:
    """An empty one, inches; to be filled and saved inside."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context({"font.size": 9, "svg.hashsalt": "conicoid", "svg.fonttype": "path"}):
        yield Figure(figsize=(width, height), layout="constrained")


def save(made: "Figure", stem: Path) -> list[Path]:
    """Write STEM.png and STEM.svg; the paths."""
    paths = [stem.with_name(stem.name + suffix) for suffix in (".png", ".svg")]
    made.savefig(paths[0], dpi=160, facecolor="white", metadata={"Software": None})
    made.savefig(paths[1], facecolor="white", metadata={"Date": None, "Creator": None})
    return paths
