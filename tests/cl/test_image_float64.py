"""Every pixel of the small scenes in binary64 against the exact image."""

from collections.abc import Callable

import pytest

from conicoid.engine import Renderer
from tests.oracle import Truth
from tests.oracle.judge import Promise, hold_to
from tests.scenes import CATALOGUE, as_scene

# The band of binary64, derived as that of binary32 is (`tests.oracle.band`), with 2^-53 for 2^-24. It counts only in
# the scenes made for it, whose ties no evaluation in binary64 can tell.
FLOAT64_BAND = 2.0**-47
# Depth: one rounding to float32 takes half a unit; what binary64 evaluation adds is below 2^-20 of a unit but where
# the root's own derivative is infinite, and there below a unit: √S errs by at most √(2^-50 T), 2^-25 of √T.
# Normals: rounding to float32 takes 2^-25 = 3e-8 of each component; binary64 evaluation beside a silhouette adds
# 2^-25 per unit of √S. Positions: as depths.
FLOAT64 = Promise(depth_steps=1, normal_error=3e-7, position_units=1)


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_pixel_is_that_of_the_exact_image(
    name: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    document = CATALOGUE[name].document
    document = {**document, "output": {**document["output"], "precision": "float64", "data_window": "full"}}
    frame = renderer.render(as_scene(document))
    truth = exact_image(name)
    told = (truth.margin >= FLOAT64_BAND) | (not CATALOGUE[name].only_exact)
    hold_to(FLOAT64, frame.planes, frame.window, truth, told)
