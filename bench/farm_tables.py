"""What was measured of a farm, as tables for docs/farm.md."""

from typing import Any

from conicoid_bench.speed.table import driver


def throughput(results: dict[str, Any]) -> str:
    """Frames a second of the farm, the service alone and the bare renderer; see farm.py."""
    rows, side = results["rows"], results["side"]
    bare, service = rows["bare"]["ms_per_frame"], rows["service"]["ms_per_frame"]
    where = f"{results['processor']}, {results['cpus']} CPUs, {driver(results)}, commit {results['commit']}"
    what = f"{results['frames']} frames of {side} × {side} pixels, median of {results['runs']} jobs"
    lines = [
        f"{where}, {what}:",
        "",
        "| | frames/s | ms for a frame | more than the service | more than bare | CPU ms for a frame |",
        "| --- | ---: | ---: | ---: | ---: | --- |",
    ]
    for name, row in rows.items():
        ms = row["ms_per_frame"]
        used = ", ".join(f"{part} {value:.1f}" for part, value in row["cpu_ms_per_frame"].items())
        lines.append(f"| {name} | {1e3 / ms:.0f} | {ms:.1f} | {ms - service:+.1f} | {ms - bare:+.1f} | {used} |")
    return "\n".join(lines) + "\n"


def recovery(results: dict[str, Any]) -> str:
    """Seconds to recover from what tests/farm/test_kill_matrix.py does to a farm."""
    where = f"{results['processor']}, {results['cpus']} CPUs, commit {results['commit']}"
    what = f"three workers, a job of {results['frames']} frames, seconds from the end of what happens"
    lines = [
        f"{where}, {what} (0.0 where the job has ended meanwhile):",
        "",
        "| what happens | to the next frame | to the job's end |",
        "| --- | ---: | ---: |",
    ]
    for name, seconds in results["seconds"].items():
        lines.append(f"| {name} | {seconds['next_frame_s']:.1f} | {seconds['job_s']:.1f} |")
    return "\n".join(lines) + "\n"
