"""`python -m tests.stress`: check pixels until there are enough, and write the report."""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from datetime import timedelta
from pathlib import Path

from conicoid.device import describe, find_device
from tests.cl.bounds_probe import BoundsProbe, sample
from tests.stress.check import Result
from tests.stress.processes import in_processes
from tests.stress.report import Run, write_report
from tests.stress.workload import jobs


def main() -> int:
    arguments = parse()
    began = time.monotonic()
    results: list[Result] = []
    pixels = 0
    work = jobs(arguments.seed)
    for result in in_processes(work, arguments.jobs, arguments.pixels, arguments.seconds):
        results.append(result)
        pixels += result.pixels
        if result.wrong:
            print(f"{result.name}, seed {result.seed}: {result.wrong} at {result.places}", flush=True)
        if len(results) % 50 == 0:
            print(f"{len(results)} scenes, {pixels:,} pixels, {time.monotonic() - began:.0f} s", flush=True)
    bounds = compared_bounds(arguments.evaluations, arguments.seed)
    device = describe(find_device()).label
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True)
    took = timedelta(seconds=round(time.monotonic() - began))
    run = Run(results, bounds, device, commit.stdout.strip(), arguments.seed, arguments.jobs, took)
    write_report(run, arguments.report)
    return 1 if bounds.beyond or any(result.wrong for result in results) else 0


def compared_bounds(evaluations: int, seed: int) -> BoundsProbe:
    """Errors of the kernels' polynomials against their bounds, that many times or a little more."""
    with tempfile.TemporaryDirectory() as folder:
        probe = BoundsProbe(Path(folder) / "kernels")
    while probe.evaluations < evaluations:
        sample(probe, [seed], per_quadric=64)
        seed += 1
    return probe


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.stress", description=__doc__)
    parser.add_argument("--pixels", type=int, default=2_000_000, help="stop after this many distinct pixels")
    parser.add_argument("--evaluations", type=int, default=1_000_000, help="of polynomials, against their bounds")
    parser.add_argument("--seconds", type=float, default=3600, help="or after this long")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--seed", type=int, default=1, help="of the first random scene")
    parser.add_argument("--report", type=Path, default=Path("docs/stress-report.md"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
