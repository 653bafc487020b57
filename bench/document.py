"""Writes what `conicoid bench speed` recorded in bench/results into docs/performance.md.

python bench/document.py
"""

import json
from pathlib import Path

from conicoid_bench.speed.table import driver, markdown

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "bench" / "results"
PAGE = ROOT / "docs" / "performance.md"
BEGIN, END = "<!-- results -->\n", "<!-- end of results -->\n"


def section(path: Path) -> str:
    """Heading, tables and pictures of one record."""
    results = json.loads(path.read_text(encoding="utf-8"))
    name, of_driver = path.stem.removeprefix("speed-"), driver(results)
    times = f"![Times of every scene on {of_driver}](../bench/results/speed-{name}.png)"
    growth = f"![Growth of times on {of_driver}](../bench/results/growth-{name}.png)"
    return f"## {of_driver}\n\n{markdown(results)}\n{times}\n\n{growth}\n"


def main() -> None:
    """Replace what stands between the markers."""
    head, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    tail = rest.split(END)[1]
    sections = "\n".join(section(path) for path in sorted(RESULTS.glob("speed-*.json")))
    PAGE.write_text(f"{head}{BEGIN}\n{sections}\n{END}{tail}", encoding="utf-8")


if __name__ == "__main__":
    main()
