"""The texts of every benchmark's results: what was measured as JSON, and a table made from it."""

import json
from pathlib import Path
from typing import Any


def write_texts(results: dict[str, Any], table: str, folder: Path, name: str) -> list[Path]:
    """Write NAME.json and NAME.md into a folder, made if need be; the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {folder / f"{name}.json": json.dumps(results, indent=1) + "\n", folder / f"{name}.md": table}
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    return list(texts)
