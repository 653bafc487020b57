"""The host's exact pixels against the independent oracle, over the catalogue's small scenes.

Of each scene: the pixels nearest to a change of winner, and a sample of the others.
"""

from collections.abc import Callable

import numpy as np
import pytest

from conicoid.exact import ExactScene
from tests.cl.exact_pixels import values
from tests.oracle import Truth
from tests.oracle.judge import float32_steps
from tests.scenes import CATALOGUE, as_scene

HARDEST = 12
STRIDE = 29


@pytest.mark.parametrize("name", CATALOGUE)
def test_winners_and_every_value_agree(name: str, exact_image: Callable[[str], Truth]) -> None:
    scene, truth = as_scene(CATALOGUE[name].document), exact_image(name)
    x0, y0 = scene.camera.crop[:2]
    exact, everything = ExactScene(scene), range(len(scene.quadrics))
    chosen = {*np.argsort(truth.margin, axis=None)[:HARDEST].tolist(), *range(0, truth.hit.size, STRIDE)}
    for place in sorted(chosen):
        row, column = np.unravel_index(place, truth.hit.shape)
        i, j = x0 + int(column), y0 + int(row)
        pixel = exact.pixel(i, j, everything)
        winner = [pixel.quadric, pixel.kind] if pixel else [-1, -1]
        assert winner == [int(truth.quadric[row, column]), int(truth.kind[row, column])], (i, j)

        got = values(exact, i, j, everything)
        expected = {
            "id": truth.id[row, column],
            "Z": truth.depth[row, column],
            "T": truth.distance[row, column],
            "ZBack": truth.back[row, column],
        }
        assert {key: got[key] for key in expected} == expected, (i, j)
        # The oracle's binary64 vectors are rounded once already: a second rounding may differ by one unit.
        for key, exact_vector in (("N", truth.normal), ("P", truth.position)):
            vector = np.array([got[f"{key}.{axis}"] for axis in "XYZ"], dtype=np.float32)
            with np.errstate(over="ignore"):
                steps = float32_steps(vector, exact_vector[row, column].astype(np.float32))
            assert np.all(steps <= 1), (key, i, j)
