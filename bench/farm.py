"""`make bench-farm`: frames a second of a farm on this machine, against the service alone and the bare renderer.

    python bench/farm.py -o DIR [--frames 500] [--runs 3]

Frames of 64 x 64 pixels, so that what is measured is all that is not rendering: a unit's way from the database
through the broker to a worker, and of its image to the object store. Writes DIR/farm-throughput.json, which document.py
puts into docs/farm.md.
"""

import argparse
import io
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from itertools import count
from pathlib import Path
from statistics import median
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the tests' way of running a farm

from conicoid.document import parse
from conicoid.engine import Renderer
from conicoid_bench.machine import machine
from conicoid_service import exr
from farm_tables import throughput
from tests.farm.farm import Farm
from tests.farm.jobs import Job
from tests.farm.processes import cpu_s
from tests.farm.servers import Servers
from tests.running import Service

_SCENE = Path(__file__).parents[1] / "examples" / "shapes.json"
_SIDE = 64
_WORKERS = 1, 2, 3
_WARMING = 60
_NEW = count()

Row = dict[str, Any]


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", required=True, type=Path)
    parser.add_argument("--frames", type=int, default=500)
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    results = _measure(arguments.frames, arguments.runs)
    arguments.output.mkdir(parents=True, exist_ok=True)
    (arguments.output / "farm-throughput.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")
    print(throughput(results))


def _measure(frames: int, runs: int) -> dict[str, Any]:
    engine = Renderer(os.environ.get("CONICOID_DEVICE"))
    results = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"), **machine(engine), "cpus": os.cpu_count(),
        "frames": frames, "runs": runs, "side": _SIDE,
        "rows": {"bare": _bare(engine, frames), "service": _service(frames, runs)},
    }  # fmt: skip
    with Servers() as servers:
        for workers in _WORKERS:
            results["rows"][f"farm {workers}"] = _farm(servers, workers, frames, runs)
    return results


def _batch(frames: int) -> dict[str, Any]:
    """Views that nobody has rendered yet."""
    document: dict[str, Any] = json.loads(_SCENE.read_text("utf-8"))
    camera = {**document.pop("camera"), "width": _SIDE, "height": _SIDE}
    return document | {"cameras": [{**camera, "far": 1000.0 + next(_NEW)} for _ in range(frames)]}


def _bare(engine: Renderer, frames: int) -> Row:
    """The engine and OpenEXR in this process, with a thread for each CPU."""
    document: dict[str, Any] = json.loads(_SCENE.read_text("utf-8"))
    document["camera"] |= {"width": _SIDE, "height": _SIDE}
    scene = parse(json.dumps(document).encode()).resolve()
    exr.set_threads(os.cpu_count() or 1)
    for wanted in (_WARMING, frames):
        start = time.perf_counter()
        for _ in range(wanted):
            frame = engine.render(scene)
            exr.write(io.BytesIO(), frame.planes, frame.window, scene.camera, scene.output, "")
        seconds = time.perf_counter() - start
    return {"ms_per_frame": 1e3 * seconds / frames, "cpu_ms_per_frame": {}}


def _service(frames: int, runs: int) -> Row:
    """A service without a farm: SQLite, a directory, one render process."""
    with tempfile.TemporaryDirectory() as folder, Service(Path(folder) / "store", Path(folder) / "log") as service:
        return _laps(service.url, frames, runs, {"service": lambda: cpu_s(service.process.pid)})


def _farm(servers: Servers, workers: int, frames: int, runs: int) -> Row:
    """An API that renders nothing, and so many workers with one render process each."""
    with tempfile.TemporaryDirectory() as folder, Farm(Path(folder), servers.environment(), workers) as farm:
        parts: dict[str, Callable[[], float]] = {
            "api": lambda: cpu_s(farm.api.process.pid),
            "workers": lambda: sum(cpu_s(worker.process.pid) for worker in farm.workers),
            "broker": lambda: cpu_s(servers.broker.process.pid),
            "database": lambda: cpu_s(servers.database.process.pid),
            "object store": lambda: cpu_s(servers.store.process.pid),
        }
        return _laps(farm.api.url, frames, runs, parts)


def _laps(url: str, frames: int, runs: int, parts: dict[str, Callable[[], float]]) -> Row:
    """Jobs from their acceptance to their end, the median; and the CPU time that each part used."""
    with _ended(url, _WARMING):
        pass
    before = {part: used() for part, used in parts.items()}
    laps = []
    for _ in range(runs):
        with _ended(url, frames) as job:
            laps.append(1e3 * _seconds(job) / frames)
    used_ms = {part: round(1e3 * (used() - before[part]) / (runs * frames), 2) for part, used in parts.items()}
    return {"ms_per_frame": median(laps), "laps": [round(lap, 3) for lap in laps], "cpu_ms_per_frame": used_ms}


@contextmanager
def _ended(url: str, frames: int) -> Iterator[dict[str, Any]]:
    """A new job, once it has ended; its stream of events says so without being asked."""
    with Job(url, _batch(frames)) as job:
        told = job.told()
        now = job.now()
        if now["state"] != "succeeded" or len(told) != frames:
            raise RuntimeError(f"the job has not gone well: {now}")
        yield now


def _seconds(job: dict[str, Any]) -> float:
    created, finished = (datetime.fromisoformat(job[key]) for key in ("created", "finished"))
    return (finished - created).total_seconds()


if __name__ == "__main__":
    main()
