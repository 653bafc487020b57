"""Results on disk, named after the driver: what was measured as JSON, and made from it a table."""

from pathlib import Path
from typing import Any

from conicoid_bench.service.table import markdown
from conicoid_bench.speed.table import driver
from conicoid_bench.texts import write_texts


def write(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write service-DRIVER.json and .md; the paths."""
    name = driver(results).lower().replace(" ", "-")
    return write_texts(results, markdown(results), folder, f"service-{name}")
