"""The engine's planes against the exact image, in the units of the promises: units in the last place, and counts."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tests.oracle.exact_image import Truth

Planes = Mapping[str, NDArray[Any]]
Window = tuple[int, int, int, int]


class Promise(NamedTuple):
    """What a precision promises: float32 steps of depth, error of N's components, units of P's largest component."""

    depth_steps: int
    normal_error: float
    position_units: float


DEPTHS = {"Z": "depth", "T": "distance", "ZBack": "back"}


def float32_steps(got: NDArray[np.float32], exact: NDArray[np.float32]) -> NDArray[np.int64]:
    """How many float32 numbers lie from one to the other; NaN is as far as can be."""
    steps: NDArray[np.int64] = np.abs(_ordinal(got) - _ordinal(exact))
    return np.where(np.isnan(got), np.iinfo(np.int64).max, steps)


def _ordinal(value: NDArray[np.float32]) -> NDArray[np.int64]:
    bits = np.ascontiguousarray(value, dtype=np.float32).view(np.int32).astype(np.int64)
    return np.where(bits < 0, -(bits & 0x7FFFFFFF), bits)


def wrong_hits(planes: Planes, truth: Truth) -> NDArray[np.bool_]:
    """Pixels whose mask or id is not the exact one, by every channel that tells."""
    wrong = np.zeros(truth.hit.shape, dtype=bool)
    if "A" in planes:
        wrong |= planes["A"] != truth.hit
    if "id" in planes:
        wrong |= planes["id"] != truth.id
    if "N.X" in planes:
        wrong |= np.any(stacked(planes, "N") != 0, axis=-1) != truth.hit
    return wrong


def stacked(planes: Planes, name: str) -> NDArray[np.float64]:
    """(..., 3) of a channel with X, Y and Z."""
    return np.stack([planes[f"{name}.{axis}"] for axis in "XYZ"], axis=-1).astype(np.float64)


def normal_error(planes: Planes, truth: Truth) -> NDArray[np.float64]:
    """Largest error of a component of N."""
    error: NDArray[np.float64] = np.abs(stacked(planes, "N") - truth.normal).max(axis=-1)
    return np.where(np.isnan(error), np.inf, error)


def position_error(planes: Planes, truth: Truth) -> NDArray[np.float64]:
    """Largest error of a component of P, in units of the last place, in float32, of the largest component."""
    largest = np.abs(truth.position).max(axis=-1)
    with np.errstate(invalid="ignore", over="ignore"):
        unit = np.spacing(largest.astype(np.float32)).astype(np.float64)
        difference = np.abs(stacked(planes, "P") - truth.position).max(axis=-1)
    # Beyond float32, inf is right.
    beyond = largest > np.finfo(np.float32).max
    error = np.where(beyond, 0.0, difference / unit)
    return np.where(np.isnan(error), np.inf, error)


def hold_to(promise: Promise, planes: Planes, window: Window, truth: Truth, told: NDArray[np.bool_]) -> None:
    """Fail with the first wrong pixels, of those that are `told`, if any channel breaks the promise."""
    wrong = wrong_hits(planes, truth) & told
    assert not wrong.any(), report(wrong, window, **planes, exact_id=truth.id, margin=truth.margin)
    for channel, field in DEPTHS.items():
        if channel in planes:
            exact = getattr(truth, field)
            wrong = (float32_steps(planes[channel], exact) > promise.depth_steps) & told
            assert not wrong.any(), channel + report(wrong, window, got=planes[channel], exact=exact)
    if "N.X" in planes:
        got = stacked(planes, "N")
        wrong = (normal_error(planes, truth) > promise.normal_error) & told
        assert not wrong.any(), "N" + report(wrong, window, got=got, exact=truth.normal)
        assert not np.any(np.signbit(got) & (got == 0)), "N has a component that is -0"
    if "P.X" in planes:
        wrong = (position_error(planes, truth) > promise.position_units) & told
        assert not wrong.any(), "P" + report(wrong, window, got=stacked(planes, "P"), exact=truth.position)


def report(places: NDArray[np.bool_], window: Window, **values: NDArray[Any]) -> str:
    """The first few pixels that are wrong, with what was got and what is exact."""
    lines = []
    for row, column in np.argwhere(places)[:5]:
        here = ", ".join(f"{name} {value[row, column]}" for name, value in values.items())
        lines.append(f"pixel ({window[0] + column}, {window[1] + row}): {here}")
    return f"{int(places.sum())} of {places.size} pixels: " + "; ".join(lines)
