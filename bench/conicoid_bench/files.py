"""Results on disk: what was measured as JSON, and made from it a table and a figure."""

import json
from pathlib import Path
from typing import Any

from conicoid_bench.figure import draw
from conicoid_bench.table import markdown


def write(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write error.json, error.md, error.png and error.svg; the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    stem = folder / "error"
    texts = {".json": json.dumps(results, indent=1) + "\n", ".md": markdown(results)}
    for suffix, text in texts.items():
        stem.with_suffix(suffix).write_text(text, encoding="utf-8")
    return [*(stem.with_suffix(suffix) for suffix in texts), *draw(results, stem)]
