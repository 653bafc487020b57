"""Results on disk, named after the driver: what was measured as JSON, and made from it tables and figures."""

import json
from pathlib import Path
from typing import Any

from conicoid_bench.speed.figure import draw_growth, draw_scenes
from conicoid_bench.speed.table import driver, markdown


def write(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write speed-DRIVER.json, .md, .png, .svg and growth-DRIVER.png, .svg; the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    name = driver(results).lower().replace(" ", "-")
    paths = [folder / f"speed-{name}{suffix}" for suffix in (".json", ".md")]
    paths[0].write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    paths[1].write_text(markdown(results), encoding="utf-8")
    return [*paths, *draw_scenes(results, folder / f"speed-{name}"), *draw_growth(results, folder / f"growth-{name}")]
