"""One scene: every contender is checked against the exact image, then all take laps in turn."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import asdict
from statistics import median
from typing import Any, Final

import numpy as np

from conicoid.scene import Scene
from conicoid_bench.measure import compare, wrong_pixels
from conicoid_bench.picture import Picture
from conicoid_bench.speed.contenders import Contender, Entry

# Who is slow takes fewer laps: all are over when each has had its share of time or all its laps.
_FEWEST: Final = 3
# The threads of the one before may wait for more work, busily.
_PAUSE_S: Final = 0.1
# A peer is right, so that its time counts, when it shows no more wrong pixels than this of the image.
RIGHT: Final = 1e-4

Check = Callable[[Picture, Picture], dict[str, Any]]
Rows = dict[str, dict[str, Any]]


def all_errors(picture: Picture, exact: Picture) -> dict[str, Any]:
    """Everything that `bench error` counts."""
    return asdict(compare(picture, exact))


def pixels_only(picture: Picture, exact: Picture) -> dict[str, Any]:
    """Wrong hits and ids: all that large images have memory for."""
    wrong_hits, wrong_ids = wrong_pixels(picture, exact)
    return {"wrong_hits": wrong_hits, "wrong_ids": wrong_ids}


def race(
    contenders: Sequence[Contender], floor: Callable[[], float], scene: Scene, exact: Picture, check: Check,
    laps: int, enough_s: float,
) -> tuple[float, Rows]:  # fmt: skip
    """Check, then time.

    Args:
        contenders: who takes part; who cannot is told why.
        floor: milliseconds of a write-only lap.
        scene: what they render.
        exact: the truth about it.
        check: what of a picture is compared with it.
        laps: of each; at least three.
        enough_s: seconds after which a contender takes no more laps, when it has had three.
    Returns:
        Median milliseconds of the floor, and under each name plain values: errors, laps, and medians of build, cast
        and both together.
    """
    rows: Rows = {}
    with ExitStack() as stack:
        entries: dict[str, Entry] = {}
        for contender in contenders:
            if reason := contender.why_not(scene):
                rows[contender.name] = {"not_measured": reason}
                continue
            entry = stack.enter_context(contender.enter(scene))
            picture = entry.picture()
            errors = check(picture, exact)
            right = errors["wrong_hits"] + errors["wrong_ids"] <= RIGHT * exact.id.size
            counts = {"refined": picture.refined, "settled": picture.settled}
            rows[contender.name] = {**errors, **counts, "right": right and contender.raced}
            if contender.raced:
                entry.lap()
                entries[contender.name] = entry
        floors, times = _laps(entries, floor, laps, enough_s)
    for name, lap in times.items():
        build, cast = np.array(lap).T
        rows[name] |= {"laps": len(lap), "build_ms": float(median(build)), "cast_ms": float(median(cast)),
                       "ms": float(median(build + cast))}  # fmt: skip
    return median(floors), rows


def _laps(
    entries: dict[str, Entry], floor: Callable[[], float], laps: int, enough_s: float
) -> tuple[list[float], dict[str, list[tuple[float, float]]]]:
    floors = [floor()]
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in entries}
    for number in range(max(laps, _FEWEST)):
        for name, entry in entries.items():
            spent = 1e-3 * sum(map(sum, times[name]))
            if number < _FEWEST or spent < enough_s:
                time.sleep(_PAUSE_S)
                floors.append(floor())
                times[name].append(entry.lap())
    return floors, times
