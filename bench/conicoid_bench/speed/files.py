"""Results on disk, named after the driver: what was measured as JSON, and made from it tables and figures."""

from pathlib import Path
from typing import Any

from conicoid_bench.speed.figure import draw_growth, draw_scenes
from conicoid_bench.speed.table import driver, markdown
from conicoid_bench.texts import write_texts


def write(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write speed-DRIVER.json, .md, .png, .svg and growth-DRIVER.png, .svg; the paths."""
    name = driver(results).lower().replace(" ", "-")
    paths = write_texts(results, markdown(results), folder, f"speed-{name}")
    return [*paths, *draw_scenes(results, folder / f"speed-{name}"), *draw_growth(results, folder / f"growth-{name}")]
