"""Every pixel of the small scenes in binary64, and in `exact`, against the exact image."""

from collections.abc import Callable

import numpy as np
import pytest

from conicoid.engine import Renderer
from tests.oracle import Truth
from tests.oracle.judge import (
    DEPTHS,
    float32_steps,
    normal_error,
    position_error,
    report,
    stacked,
    wrong_hits,
)
from tests.scenes import CATALOGUE, as_scene

# The band of binary64, derived as that of binary32 is (`tests.oracle.band`), with 2^-53 for 2^-24. It counts only in
# the scenes made for it, whose ties no evaluation in binary64 can tell.
FLOAT64_BAND = 2.0**-47
# One rounding to float32 takes half a unit; what binary64 evaluation adds is below 2^-20 of a unit but where the
# root's own derivative is infinite, and there below a unit: √S errs by at most √(2^-50 T), 2^-25 of √T.
DEPTH_STEPS = 1
POSITION_UNITS = 1.0
# Rounding to float32: 2^-25 = 3e-8 of each component; binary64 evaluation beside a silhouette: 2^-25 per unit of √S.
NORMAL_ERROR = 3e-7


@pytest.mark.parametrize("precision", ["float64", "exact"])
@pytest.mark.parametrize("name", CATALOGUE)
def test_every_pixel_is_that_of_the_exact_image(
    name: str, precision: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    document = CATALOGUE[name].document
    document = {**document, "output": {**document["output"], "precision": precision, "data_window": "full"}}
    frame = renderer.render(as_scene(document))
    planes, truth = frame.planes, exact_image(name)
    told = (truth.margin >= FLOAT64_BAND) | (not CATALOGUE[name].only_exact)

    wrong = wrong_hits(planes, truth) & told
    assert not wrong.any(), report(wrong, frame.window, **planes, exact_id=truth.id, margin=truth.margin)
    for channel, field in DEPTHS.items():
        if channel in planes:
            exact = getattr(truth, field)
            wrong = (float32_steps(planes[channel], exact) > DEPTH_STEPS) & told
            assert not wrong.any(), channel + report(wrong, frame.window, got=planes[channel], exact=exact)
    if "N.X" in planes:
        wrong = (normal_error(planes, truth) > NORMAL_ERROR) & told
        assert not wrong.any(), "N" + report(wrong, frame.window, got=stacked(planes, "N"), exact=truth.normal)
        assert not np.any(np.signbit(stacked(planes, "N")) & (stacked(planes, "N") == 0))
    if "P.X" in planes:
        wrong = (position_error(planes, truth) > POSITION_UNITS) & told
        assert not wrong.any(), "P" + report(wrong, frame.window, got=stacked(planes, "P"), exact=truth.position)
