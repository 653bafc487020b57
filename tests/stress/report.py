"""The report of a long run, as Markdown."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import timedelta
from itertools import groupby
from pathlib import Path

from tests.cl.bounds_probe import BoundsProbe
from tests.stress.check import Result

DEPTHS = ("Z", "T", "ZBack")
HEAD = """# Stress report

Written by `make stress`; do not edit. Each scene is rendered in `exact` and compared with `tests/oracle`, which decides
every pixel in integers and shares no code with the engine: mask and id, Z, T and ZBack to the last bit, N and P rounded
to their steps (2⁻²³, and the unit in the last place of the largest component), no −0. Scenes that ask for ZBack are
rendered twice, with it and without, because closed surfaces then take another path through the kernels, and once more
with ids alone, where no doubt about a depth helps. Half of a sample lies beside edges.
"""
COLUMNS = """Columns: pixels and hits that the oracle answered; wrong masks or ids; misrounded Z, T or ZBack; N and P
beyond the promise; negative zeros, each counted over all renderings of a scene; worst N in units of 2⁻²³, worst P in
units of float32 of its largest component; pixels of the first rendering's image that binary64 left open and
double-double rounded, and that exact integers decided.
"""


@dataclass(frozen=True)
class Run:
    """Results of one run and how they came about."""

    results: list[Result]
    bounds: BoundsProbe
    device: str
    commit: str
    seed: int
    processes: int
    took: timedelta


def write_report(run: Run, path: Path) -> None:
    """Totals, a table of groups, then every scene."""
    fixed = [result for result in run.results if result.seed < 0]
    pixels, hits = total(run.results, "pixels"), total(run.results, "hits")
    compared = sum(result.pixels * result.frames for result in run.results)
    lines = [
        HEAD,
        f"- Device: {run.device}.",
        f"- Commit {run.commit}, {run.processes} processes, {run.took}, first random seed {run.seed}.",
        f"- **{pixels:,} distinct pixels** answered by the oracle, {hits:,} of them hits; {compared:,} rendered.",
        f"- {len(run.results)} scenes, {len(fixed)} of them fixed and the others random.\n",
        COLUMNS,
        *table(grouped(run.results), "Group"),
        "",
        "## Errors against bounds\n",
        f"{run.bounds.evaluations:,} values of the kernels' polynomials at pixels of random scenes, compared with",
        f"exact rationals: {run.bounds.beyond} beyond their bound. Largest error over its bound:\n",
        "| polynomial | error / bound |",
        "|---|---:|",
        *(f"| {name} | {ratio:.3f} |" for name, ratio in run.bounds.worst.items()),
        "",
    ]
    for group, members in grouped(run.results):
        lines += [f"## {group}", "", *table([(label(member), [member]) for member in members], "Scene"), ""]
    path.write_text("\n".join(lines), encoding="utf-8")


def grouped(results: Iterable[Result]) -> list[tuple[str, list[Result]]]:
    in_order = sorted(results, key=lambda result: (result.seed >= 0, result.group, result.seed, result.name))
    return [(group, list(members)) for group, members in groupby(in_order, key=lambda result: result.group)]


def label(result: Result) -> str:
    return result.name if result.seed < 0 else f"{result.name}, seed {result.seed}"


def table(rows: list[tuple[str, list[Result]]], heading: str) -> list[str]:
    lines = [f"| {heading} | pixels | hits | wrong | misrounded | N | P | −0 | worst N | worst P | dd | host |",
             "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|"]  # fmt: skip
    for name, members in rows:
        depth = sum(wrong(members, channel) for channel in DEPTHS)
        normal, position = max(m.normal for m in members), max(m.position for m in members)
        escalated = " | ".join(share_of(members, stage) for stage in ("refined", "settled"))
        broken = " | ".join(str(wrong(members, promise)) for promise in ("N", "P", "zero"))
        lines.append(
            f"| {name} | {total(members, 'pixels'):,} | {total(members, 'hits'):,} | {wrong(members, 'hit')} | {depth} "
            f"| {broken} | {normal:.2f} | {position:.2f} | {escalated} |"
        )
    return lines


def share_of(members: list[Result], stage: str) -> str:
    count = total(members, stage)
    return f"{count:,} ({100 * count / total(members, 'size'):.2g} %)"


def total(results: Iterable[Result], field: str) -> int:
    return sum(int(getattr(result, field)) for result in results)


def wrong(results: Iterable[Result], promise: str) -> int:
    return sum(result.wrong.get(promise, 0) for result in results)
