"""Rendered pixels judged one by one by what `precision: exact` promises of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.exact import ExactPixel, ExactScene
from conicoid.scene import Scene
from conicoid.verify.boxes import PixelBoxes

Planes = Mapping[str, NDArray[Any]]
Place = tuple[int, int]

NORMAL_LIMIT: Final = 2.0**-23
POSITION_LIMIT: Final = 1.0
MOST_DIFFERENCES: Final = 100

_DEPTHS: Final = ("Z", "T", "ZBack")
_LARGEST: Final = float(np.finfo(np.float32).max)


@dataclass(frozen=True)
class Difference:
    """One value that breaks the promise: at column x, row y of the whole image."""

    x: int
    y: int
    channel: str
    got: float
    exact: float

    def __str__(self) -> str:
        # Nine digits tell any two binary32 numbers apart.
        return f"pixel ({self.x}, {self.y}): {self.channel} is {self.got:.9g}, exactly {self.exact:.9g}"


@dataclass
class Verdict:
    """What was found; counts are of pixels.

    Attributes:
        pixels: how many were checked; hits: how many of them show a quadric in the exact image.
        wrong_hits: a hit shown as a miss, or the other way round.
        wrong_ids: a hit of another quadric.
        misrounded: by depth channel: not the exact value rounded to nearest, ties to even.
        normal_error: largest error of a component of N.
        position_error: largest error of a component of P, in float32 ulp of P's largest component.
        wrong: pixels with any of these beyond the promise.
        differences: what is wrong, up to MOST_DIFFERENCES values in the order of checking.
    """

    pixels: int = 0
    hits: int = 0
    wrong_hits: int = 0
    wrong_ids: int = 0
    misrounded: dict[str, int] = field(default_factory=dict)
    normal_error: float | None = None
    position_error: float | None = None
    wrong: int = 0
    differences: list[Difference] = field(default_factory=list)


def check(
    scene: Scene,
    planes: Planes,
    window: tuple[int, int, int, int],
    places: NDArray[np.intp],
    *,
    after_each: Callable[[], object] = lambda: None,
) -> Verdict:
    """Judge some pixels of a rendered image.

    Args:
        scene: what was rendered.
        planes: (h, w) arrays by EXR channel name; the more there are, the more is checked.
        window: (x0, y0, x1, y1), half-open, where they lie in the whole image.
        places: (m, 2) rows and columns in the planes; quickest in order.
        after_each: called after each pixel, for a progress bar.
    """
    exact, boxes = ExactScene(scene), PixelBoxes(scene)
    judge = _Judge(exact, planes)
    for row, column in places.tolist():
        x, y = window[0] + column, window[1] + row
        judge.pixel((row, column), (x, y), exact.pixel(x, y, boxes.at(x, y)))
        after_each()
    return judge.verdict


class _Judge:
    """Fills in a verdict."""

    def __init__(self, exact: ExactScene, planes: Planes) -> None:
        self._exact, self._planes = exact, planes
        has = set(planes)
        self.verdict = Verdict(
            misrounded={name: 0 for name in _DEPTHS if name in has},
            normal_error=0.0 if "N.X" in has else None,
            position_error=0.0 if "P.X" in has else None,
        )

    def pixel(self, place: Place, at: Place, pixel: ExactPixel | None) -> None:
        verdict = self.verdict
        wrong = self._differences(place, pixel)
        verdict.pixels += 1
        verdict.hits += pixel is not None
        verdict.wrong += bool(wrong)
        room = MOST_DIFFERENCES - len(verdict.differences)
        verdict.differences += [Difference(*at, name, got, exact) for name, got, exact in wrong[:room]]

    def _differences(self, place: Place, pixel: ExactPixel | None) -> list[tuple[str, float, float]]:
        """Channel, value and exact value of what is wrong; after a wrong hit or id nothing else is asked."""
        verdict, planes = self.verdict, self._planes
        if wrong := self._unlike(place, "A", pixel):
            verdict.wrong_hits += 1
            return wrong
        if wrong := self._unlike(place, "id", pixel):
            if pixel is None or planes["id"][place] == 0:
                verdict.wrong_hits += 1
            else:
                verdict.wrong_ids += 1
            return wrong
        for name in verdict.misrounded:
            if found := self._unlike(place, name, pixel):
                verdict.misrounded[name] += 1
                wrong += found
        if verdict.normal_error is not None:
            error = self._error(place, "N", pixel)
            verdict.normal_error = max(verdict.normal_error, error)
            wrong += self._vectors(place, "N", pixel) if error > NORMAL_LIMIT else []
        if verdict.position_error is not None:
            error = self._error(place, "P", pixel)
            verdict.position_error = max(verdict.position_error, error)
            wrong += self._vectors(place, "P", pixel) if error > POSITION_LIMIT else []
        return wrong

    def _unlike(self, place: Place, channel: Any, pixel: ExactPixel | None) -> list[tuple[str, float, float]]:
        if channel not in self._planes:
            return []
        got, exact = float(self._planes[channel][place]), self._exact.channel(channel, pixel)[channel]
        return [] if got == exact else [(channel, got, exact)]

    def _error(self, place: Place, channel: str, pixel: ExactPixel | None) -> float:
        """Largest error of a component, of P in ulp of the largest one; only zeros are right on a miss."""
        got = [float(self._planes[f"{channel}.{axis}"][place]) for axis in "XYZ"]
        if pixel is None:
            return np.inf if any(got) else 0.0
        errors = pixel.normal_errors(got) if channel == "N" else pixel.position_errors(got)
        unit = 1.0
        if channel == "P":
            largest = max(map(abs, pixel.position))
            unit = float(np.spacing(np.float32(min(largest, _LARGEST))))
        return max(errors) / unit

    def _vectors(self, place: Place, channel: Any, pixel: ExactPixel | None) -> list[tuple[str, float, float]]:
        exact = self._exact.channel(channel, pixel)
        return [(name, float(self._planes[name][place]), value) for name, value in exact.items()]
