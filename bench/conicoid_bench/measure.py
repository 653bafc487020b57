"""One renderer on one scene: how long it takes, and how far it is from the exact image."""

import time
from dataclasses import asdict, dataclass
from statistics import median
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Scene
from conicoid_bench.picture import Job, Picture, Renderer

# At least three runs after the warming one, more while they are short.
_RUNS: Final = range(3, 16)
_ENOUGH_S: Final = 3.0
_PAUSE_S: Final = 0.3


@dataclass(frozen=True)
class Errors:
    """A picture against the exact one.

    Depths and normals are compared where both show the same quadric.

    Attributes:
        wrong_hits: pixels that are a hit in one and a miss in the other.
        wrong_ids: pixels that show another quadric.
        worst_ulp, median_ulp: float32 numbers between the depth and the exact one, rounded; None without a pixel.
        worst_degrees: largest angle between normals, as lines; None without a pixel.
    """

    wrong_hits: int
    wrong_ids: int
    worst_ulp: int | None
    median_ulp: float | None
    worst_degrees: float | None


def compare(picture: Picture, exact: Picture) -> Errors:
    """The errors of a picture; `exact` has exact ids and depths rounded to nearest."""
    wrong_hits, wrong_ids = wrong_pixels(picture, exact)
    same = (exact.id != 0) & (picture.id == exact.id)
    if not same.any():
        return Errors(wrong_hits, wrong_ids, None, None, None)
    steps = float32_steps(picture.depth[same], exact.depth[same])
    degrees = angles(picture.normal[same], exact.normal[same])
    return Errors(wrong_hits, wrong_ids, int(steps.max()), float(np.median(steps)), float(degrees.max()))


def wrong_pixels(picture: Picture, exact: Picture) -> tuple[int, int]:
    """How many are a hit in one and a miss in the other, and how many show another quadric."""
    hit, truth = picture.id != 0, exact.id != 0
    return int(np.count_nonzero(hit != truth)), int(np.count_nonzero(hit & truth & (picture.id != exact.id)))


def float32_steps(got: NDArray[np.float32], exact: NDArray[np.float32]) -> NDArray[np.int64]:
    """How many float32 numbers lie from one to the other; infinity is the one after the largest, NaN beyond that."""
    steps: NDArray[np.int64] = np.abs(_ordinal(got) - _ordinal(exact))
    return np.where(np.isnan(got), np.int64(1) << 32, steps)


def _ordinal(value: NDArray[np.float32]) -> NDArray[np.int64]:
    bits = np.ascontiguousarray(value, dtype=np.float32).view(np.int32).astype(np.int64)
    return np.where(bits < 0, -(bits & 0x7FFFFFFF), bits)


def angles(got: NDArray[np.float32], exact: NDArray[np.float32]) -> NDArray[np.float64]:
    """(n,) degrees between the lines along (n, 3) vectors, 0 to 90; 90 for what is no direction.

    Lines, because at a grazing ray rounding alone says to which side a normal is turned to face the camera.
    """
    first, second = got.astype(np.float64), exact.astype(np.float64)
    # Kahan's form: it does not lose small angles.
    with np.errstate(invalid="ignore"):
        first = first / np.linalg.norm(first, axis=1, keepdims=True)
        second = second / np.linalg.norm(second, axis=1, keepdims=True)
        apart, together = np.linalg.norm(first - second, axis=1), np.linalg.norm(first + second, axis=1)
        degrees = np.degrees(2 * np.arctan2(np.minimum(apart, together), np.maximum(apart, together)))
    return np.where(np.isnan(degrees), 90.0, degrees)


def timed(job: Job) -> tuple[Any, list[float]]:
    """What the last run returned, and the milliseconds of each run after a first one that warms."""
    # The threads of the one before may wait for more work, busily.
    time.sleep(_PAUSE_S)
    job.run()
    times: list[float] = []
    while len(times) < _RUNS.start or (len(times) < _RUNS.stop and sum(times) < 1e3 * _ENOUGH_S):
        begin = time.perf_counter()
        result = job.run()
        times.append(1e3 * (time.perf_counter() - begin))
    return result, times


def measured(renderer: Renderer, scene: Scene, exact: Picture) -> dict[str, Any]:
    """Plain values: milliseconds to prepare and (the median) to render, runs, errors, pixels refined and settled."""
    begin = time.perf_counter()
    job = renderer.prepare(scene)
    prepare_ms = 1e3 * (time.perf_counter() - begin)
    result, times = timed(job)
    picture = job.picture(result)
    errors = asdict(compare(picture, exact))
    counts = {"refined": picture.refined, "settled": picture.settled}
    return {"prepare_ms": prepare_ms, "ms": median(times), "runs": len(times), **errors, **counts}
