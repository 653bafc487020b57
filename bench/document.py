"""Writes what was recorded in bench/results into docs/performance.md and docs/farm.md.

python bench/document.py
"""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from conicoid_bench.service.table import markdown as service_tables
from conicoid_bench.speed.table import driver, markdown
from farm_tables import recovery, throughput

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "bench" / "results"
PAGE = ROOT / "docs" / "performance.md"
FARM_PAGE = ROOT / "docs" / "farm.md"


def section(path: Path) -> str:
    """Heading, tables and pictures of one record."""
    results = json.loads(path.read_text(encoding="utf-8"))
    name, of_driver = path.stem.removeprefix("speed-"), driver(results)
    times = f"![Times of every scene on {of_driver}](../bench/results/speed-{name}.png)"
    growth = f"![Growth of times on {of_driver}](../bench/results/growth-{name}.png)"
    return f"## {of_driver}\n\n{markdown(results)}\n{times}\n\n{growth}\n"


def service_section(path: Path) -> str:
    """Tables of one record of the service."""
    return service_tables(json.loads(path.read_text(encoding="utf-8")))


def farm_section(name: str, table: Callable[[dict[str, Any]], str]) -> str:
    """A table of what `make bench-farm` recorded."""
    return table(json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8")))


def replaced(page: str, name: str, sections: Iterable[str]) -> str:
    """The page with these sections between the markers of this name."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    head, rest = page.split(begin)
    content = "\n".join(sections)
    return f"{head}{begin}\n{content}\n{end}{rest.split(end)[1]}"


def main() -> None:
    """Replace what stands between the markers."""
    page = PAGE.read_text(encoding="utf-8")
    page = replaced(page, "results", map(section, sorted(RESULTS.glob("speed-*.json"))))
    page = replaced(page, "service", map(service_section, sorted(RESULTS.glob("service-*.json"))))
    PAGE.write_text(page, encoding="utf-8")
    page = FARM_PAGE.read_text(encoding="utf-8")
    page = replaced(page, "recovery", [farm_section("farm-recovery", recovery)])
    page = replaced(page, "throughput", [farm_section("farm-throughput", throughput)])
    FARM_PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
