"""What times grow with: number of quadrics, pixels, share of the image covered, surfaces behind each other."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import log2

from conicoid.scene import Scene
from conicoid_bench.workloads import camera, ellipsoids, sphere_over


@dataclass(frozen=True)
class Sweep:
    """One quantity, all others kept.

    Attributes:
        name: of the quantity.
        axis: what is varied, and what is kept.
        values: ascending.
        scene: of each value.
    """

    name: str
    axis: str
    values: tuple[float, ...]
    scene: Callable[[float], Scene]


def sweeps(quick: bool = False, most_quadrics: int = 10**6) -> Iterable[Sweep]:
    """All, shorter where it must be quick."""
    counts = [10**power for power in range(8) if 10**power <= min(most_quadrics, 10**5 if quick else most_quadrics)]
    yield Sweep("quadrics", "ellipsoids that together have the image's area", tuple(counts),
                lambda count: ellipsoids(int(count), 1.0))  # fmt: skip
    sides = [64 << power for power in range(6 if quick else 8)]
    yield Sweep("pixels", "pixels of a square image of 1,000 ellipsoids", tuple(side * side for side in sides), _square)
    shares = (0.01, 0.04, 0.16, 0.64) if quick else (0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64)
    yield Sweep("coverage", "share of the image that one sphere covers", shares, sphere_over)
    depths = [1 << power for power in range(0, 8, 2 if quick else 1)]
    yield Sweep("overlap", "ellipsoids of 1 % of the image behind each pixel, on average", tuple(depths),
                lambda depth: ellipsoids(int(100 * depth), float(depth)))  # fmt: skip


def _square(pixels: float) -> Scene:
    side = round(pixels**0.5)
    return replace(ellipsoids(1000, 1.0), camera=camera(side, side))


def per_doubling(values: Iterable[float], times: Iterable[float]) -> list[float]:
    """Between one value and the next, the factor by which time grows when the value doubles."""
    points = list(zip(values, times, strict=True))
    steps = zip(points, points[1:], strict=False)
    return [(after / before) ** (1 / log2(high / low)) for (low, before), (high, after) in steps]
