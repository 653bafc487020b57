"""What times grow with: number of quadrics, pixels, share of the image covered, surfaces behind each other."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import log2, log10
from typing import Final

from conicoid.scene import Scene
from conicoid_bench.workloads import camera, ellipsoids, sphere_over

_QUICK_QUADRICS: Final = 10**5
_DIGITS: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Sweep:
    """One quantity, all others kept.

    Attributes:
        name: of the quantity.
        axis: what is varied, and what is kept.
        values: ascending.
        scene: of each value.
        label: how a value is written.
    """

    name: str
    axis: str
    values: Sequence[float]
    scene: Callable[[float], Scene]
    label: Callable[[float], str]


def sweeps(quick: bool = False, most_quadrics: int = 10**6) -> Iterator[Sweep]:
    """All, shorter where it must be quick; the one over quadrics ends at `most_quadrics`."""
    most = min(most_quadrics, _QUICK_QUADRICS) if quick else most_quadrics
    counts = [10**power for power in range(8) if 10**power <= most]
    yield Sweep(
        "quadrics",
        "ellipsoids that together have the image's area",
        counts,
        lambda count: ellipsoids(int(count), 1.0),
        lambda count: "10" + str(round(log10(count))).translate(_DIGITS),
    )
    areas = [(64 << power) ** 2 for power in range(6 if quick else 8)]
    yield Sweep(
        "pixels", "pixels of a square image of 1,000 ellipsoids", areas, _square, lambda area: f"{area**0.5:.0f}²"
    )
    shares = [2**power / 100 for power in range(0, 7, 2 if quick else 1)]
    yield Sweep("coverage", "share of the image that one sphere covers", shares, sphere_over, "{:.0%}".format)
    depths = [1 << power for power in range(0, 8, 2 if quick else 1)]
    yield Sweep("overlap", "ellipsoids of 1 % of the image behind each pixel, on average", depths,
                lambda depth: ellipsoids(int(100 * depth), float(depth)), str)  # fmt: skip


def _square(pixels: float) -> Scene:
    side = round(pixels**0.5)
    return replace(ellipsoids(1000, 1.0), camera=camera(side, side))


def per_doubling(values: Iterable[float], times: Iterable[float]) -> list[float]:
    """Between one value and the next, the factor by which time grows when the value doubles."""
    steps = pairwise(zip(values, times, strict=True))
    return [(after / before) ** (1 / log2(high / low)) for (low, before), (high, after) in steps]
