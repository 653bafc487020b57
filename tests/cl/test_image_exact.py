"""Every pixel of the small scenes, ties and all, in `exact`: it is the exact image."""

from collections.abc import Callable

import pytest

from conicoid.engine import Renderer
from tests.oracle import Truth
from tests.oracle.judge import Promise, hold_to
from tests.scenes import CATALOGUE, as_scene

# Depths are the exact values rounded to nearest-even; the rest as the contract has it, section 5.
EXACT = Promise(depth_steps=0, normal_error=2.0**-23, position_units=1)


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_pixel_is_that_of_the_exact_image(
    name: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    document = CATALOGUE[name].document
    document = {**document, "output": {**document["output"], "precision": "exact", "data_window": "full"}}
    frame = renderer.render(as_scene(document))
    truth = exact_image(name)
    hold_to(EXACT, frame.planes, frame.window, truth, truth.margin >= 0)
