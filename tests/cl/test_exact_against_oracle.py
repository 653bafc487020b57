"""The host's exact pixels against the independent oracle, over the catalogue's small scenes.

Of each scene: the pixels nearest to a change of winner, and a sample of the others.
"""

from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest

from conicoid.exact import ExactScene
from tests.cl.exact_pixels import values
from tests.oracle import Truth
from tests.oracle.judge import normal_error, position_error
from tests.oracle.promise import NORMAL_ERROR, POSITION_UNITS
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
        # The oracle's binary64 vectors are rounded once already.
        one = (slice(row, row + 1), slice(column, column + 1))
        vectors = {key: np.full((1, 1), value, np.float32) for key, value in got.items() if key[1:2] == "."}
        answer = Truth(*(getattr(truth, field.name)[one] for field in fields(Truth)))
        assert normal_error(vectors, answer) <= NORMAL_ERROR, (i, j)
        assert position_error(vectors, answer) <= POSITION_UNITS, (i, j)
