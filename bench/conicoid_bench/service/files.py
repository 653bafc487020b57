"""Results on disk, named after the driver: what was measured as JSON, and made from it a table."""

import json
from pathlib import Path
from typing import Any

from conicoid_bench.service.table import markdown
from conicoid_bench.speed.table import driver


def write(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write service-DRIVER.json and .md; the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    name = driver(results).lower().replace(" ", "-")
    paths = [folder / f"service-{name}{suffix}" for suffix in (".json", ".md")]
    paths[0].write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    paths[1].write_text(markdown(results), encoding="utf-8")
    return paths
