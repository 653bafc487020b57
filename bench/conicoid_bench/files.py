"""Results on disk: what was measured as JSON, and made from it a table and a figure."""

from pathlib import Path
from typing import Any

from conicoid_bench.figure import draw
from conicoid_bench.table import markdown
from conicoid_bench.texts import write_texts


def write(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write error.json, error.md, error.png and error.svg; the paths."""
    return [*write_texts(results, markdown(results), folder, "error"), *draw(results, folder / "error")]
