"""Every pixel of the small scenes in binary32: right outside the band that `tests.oracle.band` derives."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from conicoid.engine import Renderer
from tests.oracle import Truth
from tests.oracle.band import FLOAT32_BAND
from tests.oracle.judge import DEPTHS, float32_steps, normal_error, report, stacked, wrong_hits
from tests.scenes import CATALOGUE, as_scene

# Where rounding the coefficients alone costs no more units than this, binary32 must not cost more in all.
DEPTH_UNITS = 4
# Six roundings at the centre of a tile, four times the pixel's own spread (`tests.oracle.band`).
ROUNDINGS = 24
UNIT = 2.0**-24


@pytest.mark.parametrize("name", CATALOGUE)
def test_outside_the_band_nothing_is_wrong(name: str, renderer: Renderer, exact_image: Callable[[str], Truth]) -> None:
    document = CATALOGUE[name].document
    document = {**document, "output": {**document["output"], "precision": "float32", "data_window": "full"}}
    frame = renderer.render(as_scene(document))
    planes, truth = frame.planes, exact_image(name)
    clear = truth.margin >= FLOAT32_BAND

    wrong = wrong_hits(planes, truth) & clear
    assert not wrong.any(), report(wrong, frame.window, **planes, exact_id=truth.id, margin=truth.margin)
    for channel, field in DEPTHS.items():
        if channel in planes:
            condition = truth.back_condition if channel == "ZBack" else truth.condition
            clear_depth = clear & (truth.back_margin >= FLOAT32_BAND) if channel == "ZBack" else clear
            exact = getattr(truth, field)
            wrong = clear_depth & (float32_steps(planes[channel], exact) > depth_steps(condition))
            got = {"got": planes[channel], "exact": exact, "condition": condition}
            assert not wrong.any(), channel + report(wrong, frame.window, **got)
    if "N.X" in planes:
        normals = stacked(planes, "N")
        allowed = UNIT * (1 + ROUNDINGS * truth.normal_condition)
        wrong = clear & (normal_error(planes, truth) > allowed)
        got = {"got": normals, "exact": truth.normal, "condition": truth.normal_condition}
        assert not wrong.any(), "N" + report(wrong, frame.window, **got)
        assert not np.any(np.signbit(normals) & (normals == 0))
        length = np.linalg.norm(normals, axis=-1)
        # Three squares, two sums, a root, a reciprocal, a product: at most eight halves of a unit in the last place.
        assert np.all(np.abs(length - truth.hit)[clear] <= 8 * UNIT)


def depth_steps(condition: NDArray[np.float64]) -> NDArray[np.float64]:
    """4 units where coefficients alone cannot cost them; beyond, all roundings' worst case."""
    return np.where(condition <= DEPTH_UNITS, DEPTH_UNITS, ROUNDINGS * condition)


def test_the_band_leaves_most_pixels_to_judge(exact_image: Callable[[str], Truth]) -> None:
    # Otherwise the test above would say nothing: of the pixels of all scenes at most 5 % may be in the band (planes
    # through pixel centres and ties, made to be there), and half of the hits must be held to 4 units.
    truths = [exact_image(name) for name in CATALOGUE]
    in_band = sum(int((truth.margin < FLOAT32_BAND).sum()) for truth in truths)
    strict = sum(int((truth.hit & (truth.condition <= DEPTH_UNITS)).sum()) for truth in truths)
    assert in_band <= 0.05 * sum(truth.hit.size for truth in truths)
    assert strict >= 0.5 * sum(int(truth.hit.sum()) for truth in truths)
