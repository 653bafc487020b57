"""`make load`: more than the service can do, for minutes, and what becomes of latency, memory and descriptors.

    python bench/load.py --locust LOCUST -o DIR [--minutes 10] [--users 80]

Writes DIR/load.json and the page between the markers of docs/service.md.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the tests' way of running a service

from conicoid_bench.machine import commit, processor
from tests.running import Service

_SAMPLE_S = 5.0
_PAGE = Path(__file__).parents[1] / "docs" / "service.md"
_MARKERS = "<!-- load -->\n", "<!-- end of load -->\n"


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--locust", required=True)
    parser.add_argument("-o", "--output", required=True, type=Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--users", type=int, default=80)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        results = _measure(Path(folder), arguments)
    arguments.output.mkdir(parents=True, exist_ok=True)
    (arguments.output / "load.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")
    _write_page(_table(results))


def _measure(folder: Path, arguments: argparse.Namespace) -> dict[str, Any]:
    service = Service(folder / "store", folder / "log")
    samples: list[dict[str, float]] = []
    over = threading.Event()
    with service:
        sampler = threading.Thread(target=_sample, args=(service.process.pid, folder / "store", samples, over))
        sampler.start()
        command = [arguments.locust, "--locustfile", Path(__file__).with_name("load_users.py"), "--host", service.url,
                   "--headless", "--users", str(arguments.users), "--spawn-rate", "10", "--only-summary",
                   "--run-time", f"{round(arguments.minutes * 60)}s", "--csv", folder / "load"]  # fmt: skip
        exit_status = subprocess.run(command, check=False).returncode
        over.set()
        sampler.join()
        stopped = service.stop()
    with (folder / "load_stats.csv").open(newline="") as file:
        requests = list(csv.DictReader(file))
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"), "commit": commit(), "processor": processor(),
        "cpus": os.cpu_count(), "minutes": arguments.minutes, "users": arguments.users, "locust": exit_status,
        "service": stopped, "samples": samples, "requests": requests,
    }  # fmt: skip


def _sample(pid: int, store: Path, samples: list[dict[str, float]], over: threading.Event) -> None:
    """Every few seconds: resident megabytes, descriptors and processes of the service, files of the store."""
    start = time.monotonic()
    while not over.wait(_SAMPLE_S):
        family = [pid, *_children(pid)]
        samples.append(
            {
                "s": round(time.monotonic() - start, 1),
                "api_mb": round(_resident_mb(pid), 1),
                "all_mb": round(sum(map(_resident_mb, family)), 1),
                "descriptors": len([*Path(f"/proc/{pid}/fd").iterdir()]),
                "processes": len(family),
                "incoming": len(list((store / "images" / "incoming").iterdir())),
            }
        )


def _children(pid: int) -> list[int]:
    return [int(one) for path in Path(f"/proc/{pid}/task").glob("*/children") for one in path.read_text().split()]


def _resident_mb(pid: int) -> float:
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except FileNotFoundError:
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def _table(results: dict[str, Any]) -> str:
    samples = results["samples"]
    middle, last = samples[len(samples) // 3], samples[-1]
    ran = f"{results['users']} users for {results['minutes']:g} minutes"
    lines = [
        f"{results['processor']}, {results['cpus']} CPUs, commit {results['commit']}, {ran}. Milliseconds:",
        "",
        "| request | answers | a second | median | 95 % | 99 % | longest | failures |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
        *map(_request_row, results["requests"]),
        "",
        "| after | API process, MB | all processes, MB | descriptors of the API process | processes |",
        "| --- | ---: | ---: | ---: | ---: |",
        *map(_sample_row, (samples[0], middle, last)),
    ]
    return "\n".join(lines) + "\n"


def _request_row(row: dict[str, str]) -> str:
    count, rate = int(row["Request Count"]), float(row["Requests/s"])
    times = " | ".join(row[key] for key in ("50%", "95%", "99%", "100%"))
    return f"| {row['Name']} | {count:,} | {rate:.1f} | {times} | {row['Failure Count']} |"


def _sample_row(sample: dict[str, float]) -> str:
    megabytes = f"{sample['api_mb']:.0f} | {sample['all_mb']:.0f}"
    return f"| {sample['s']:.0f} s | {megabytes} | {sample['descriptors']} | {sample['processes']} |"


def _write_page(table: str) -> None:
    page = _PAGE.read_text("utf-8")
    before, rest = page.split(_MARKERS[0])
    after = rest.split(_MARKERS[1])[1]
    _PAGE.write_text(f"{before}{_MARKERS[0]}\n{table}\n{_MARKERS[1]}{after}", "utf-8")


if __name__ == "__main__":
    main()
