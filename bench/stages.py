"""Set-up, cast and encode of examples and generated scenes, beside a kernel that only writes the same planes.

    python bench/stages.py [--device "PoCL 3.1"] [--repeats 15]

Times are medians over warmed-up runs in one process; the write-only kernel runs in turn with every render. Writes
bench/results/stages-<driver>.json; `python bench/stages.py --table` rewrites the table of docs/performance.md from
all such files.
"""

import argparse
import json
import platform
import re
import statistics
import subprocess
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl

from conicoid.canonical import scene_hash
from conicoid.device import find_device
from conicoid.document import parse
from conicoid.engine import Renderer
from conicoid.memory import Queue
from conicoid.scene import Precision, Scene
from conicoid_bench.workloads import ellipsoids
from conicoid_service.exr import encode

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "bench" / "results"
PAGE = ROOT / "docs" / "performance.md"
PRECISIONS: tuple[Precision, ...] = ("exact", "float64", "float32")
EXAMPLES = ("lysozyme", "shapes", "far", "orthographic")

_FILL = """
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void fill_row(__global float8 *planes, int vectors)
{
    __global float8 *row = planes + (long)get_global_id(0) * vectors;
    for (int k = 0; k < vectors; k++)
        row[k] = (float8)(1.0f);
}
"""


class WriteOnly:
    """The floor: four planes of an image filled in row order by plain vector stores."""

    def __init__(self, device: str) -> None:
        self._queue = Queue(find_device(device))
        self._kernel = pyopencl.Program(self._queue.context, _FILL).build().fill_row

    def milliseconds(self, scene: Scene) -> float:
        """One warmed-up launch over four planes of the scene's image."""
        rows, vectors = 4 * scene.camera.height, scene.camera.width // 8
        planes = self._queue.empty(32 * rows * vectors)
        self._queue.run_grid(self._kernel, (rows, 1), planes, np.int32(vectors))
        start = time.perf_counter()
        self._queue.run_grid(self._kernel, (rows, 1), planes, np.int32(vectors))
        return 1e3 * (time.perf_counter() - start)


def scenes() -> dict[str, Scene]:
    """By name: the examples, then spheres and ellipsoids that would cover 0.6, 0.6, 1 and 3 images side by side."""
    read = {f"examples/{name}.json": parse((ROOT / "examples" / f"{name}.json").read_bytes()) for name in EXAMPLES}
    made = {
        "1 sphere": ellipsoids(1, 0.6),
        "64 ellipsoids": ellipsoids(64, 0.6),
        "1,000 ellipsoids": ellipsoids(1000, 1.0),
        "100,000 ellipsoids": ellipsoids(100_000, 3.0),
    }
    return {name: document.resolve() for name, document in read.items()} | made


def measure(device: str, repeats: int) -> dict[str, Any]:
    """Medians in ms of every scene and precision on one device."""
    renderer, floor = Renderer(device), WriteOnly(device)
    rows = []
    for name, scene in scenes().items():
        row: dict[str, Any] = {"scene": name, "quadrics": len(scene.quadrics)}
        for precision in PRECISIONS:
            view = replace(scene, output=replace(scene.output, channels=("Z", "N"), precision=precision))
            for _ in range(3):
                renderer.render(view)
            write, frames = [], []
            for _ in range(repeats):
                write.append(floor.milliseconds(view))
                frames.append(renderer.render(view))
            row[precision] = {
                "write_only": statistics.median(write),
                "setup": statistics.median(frame.setup_ms for frame in frames),
                "cast": statistics.median(frame.cast_ms for frame in frames),
                "settled": frames[-1].settled,
            }
            if precision == "exact":
                start = time.perf_counter()
                encode(frames[-1], view, scene_hash(view))
                row["encode"] = 1e3 * (time.perf_counter() - start)
        rows.append(row)
        print(json.dumps(row), flush=True)
    commit = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return {"device": renderer.device.as_dict(), "processor": _processor(), "commit": commit.stdout.strip(),
            "repeats": repeats, "rows": rows}  # fmt: skip


def _processor() -> str:
    found = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    return found[1] if found else platform.processor()


def table(results: list[dict[str, Any]]) -> str:
    """Markdown: one row for each scene and driver."""
    lines = []
    for result in results:
        driver = re.search(r"PoCL [\d.]+", result["device"]["version"])
        name = driver[0] if driver else result["device"]["platform"]
        units, commit, repeats = result["device"]["compute_units"], result["commit"], result["repeats"]
        lines += [
            f"**{name}**, {result['processor']}, {units} threads, commit {commit}, medians of {repeats}, ms:",
            "",
            "| scene | write only | set-up | cast `exact` | `float64` | `float32` | settled | encode `zip` |",
            "|---|---|---|---|---|---|---|---|",
        ]
        for row in result["rows"]:
            exact = row["exact"]
            casts = " | ".join(f"{row[precision]['cast']:.1f}" for precision in PRECISIONS)
            lines.append(f"| {row['scene']} | {exact['write_only']:.1f} | {exact['setup']:.1f} | {casts} "
                         f"| {exact['settled']} px | {row['encode']:.0f} |")  # fmt: skip
        lines.append("")
    return "\n".join(lines)


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="", help="as CONICOID_DEVICE")
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--table", action="store_true", help="only rewrite docs/performance.md")
    arguments = parser.parse_args()
    if not arguments.table:
        result = measure(arguments.device, arguments.repeats)
        driver = re.search(r"PoCL (\d+\.\d+)", result["device"]["version"])
        path = RESULTS / f"stages-{'pocl-' + driver[1] if driver else 'device'}.json"
        path.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    text = PAGE.read_text(encoding="utf-8")
    results = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(RESULTS.glob("stages-*.json"))]
    head, tail = text.split("<!-- table -->")[0], text.split("<!-- end of table -->")[1]
    body = f"{head}<!-- table -->\n{table(results)}<!-- end of table -->{tail}"
    PAGE.write_text(body, encoding="utf-8")


if __name__ == "__main__":
    main()
