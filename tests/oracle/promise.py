"""Where a frame breaks the promise of `exact` (contract, section 5), or what the engine promises beyond it.

Components of N and P are not only within a bound, but the exact ones rounded to multiples of a step.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.oracle.exact_image import Truth
from tests.oracle.judge import DEPTHS, float32_steps, normal_error, position_error, stacked, wrong_hits

NORMAL_STEP = 2.0**-23
# Half a step; the reference's own normals are within 2^-52 of exact, its positions within a millionth of their unit.
NORMAL_ERROR = NORMAL_STEP / 2 + 2.0**-52
POSITION_UNITS = 0.5 + 2.0**-20


def broken(planes: Mapping[str, NDArray[Any]], truth: Truth) -> dict[str, NDArray[np.bool_]]:
    """The pixels that break promises, by `hit`, depth channel, `N`, `P` or `zero` (a -0), of broken promises alone."""
    found = {"hit": wrong_hits(planes, truth), "zero": np.zeros(truth.hit.shape, dtype=bool)}
    for channel, field in DEPTHS.items():
        if channel in planes:
            found[channel] = float32_steps(planes[channel], getattr(truth, field)) > 0
    if "N.X" in planes:
        found["N"] = ~(normal_error(planes, truth) <= NORMAL_ERROR)
        found["N"] |= np.any(stacked(planes, "N") % NORMAL_STEP != 0, axis=-1)
    if "P.X" in planes:
        found["P"] = ~(position_error(planes, truth) <= POSITION_UNITS)
    for name, plane in planes.items():
        if name != "id":
            found["zero"] |= np.signbit(plane) & (plane == 0)
    return {promise: pixels for promise, pixels in found.items() if pixels.any()}
