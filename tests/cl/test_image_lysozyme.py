"""A protein of 3,940 quadrics at 1920×1080: sampled pixels, most of them on edges, against the exact image."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from conicoid.engine import Renderer
from tests.oracle import Oracle, Truth
from tests.oracle.band import FLOAT32_BAND
from tests.oracle.judge import DEPTHS, float32_steps, normal_error, position_error, stacked, wrong_hits
from tests.scenes import Document, as_scene
from tests.scenes.catalogue import CHANNELS

EXAMPLES = Path(__file__).parents[2] / "examples"
# Far from the origin the same numbers are other numbers, rounded: another scene, as good as the first.
AWAY = np.array([1e7, -1e7, 1e7])
EDGES, ANYWHERE = 250, 100


def lysozyme(away: bool) -> Document:
    document: Document = json.loads((EXAMPLES / "lysozyme.json").read_bytes())
    document["output"] = {"channels": CHANNELS}
    if away:
        pose = document["camera"]["look_at"]
        pose["eye"], pose["target"] = (pose["eye"] + AWAY).tolist(), (pose["target"] + AWAY).tolist()
        for quadric in document["quadrics"]:
            quadric["center"] = (quadric["center"] + AWAY).tolist()
    return document


class Sample:
    """Pixels chosen in the engine's own image, with their exact answers."""

    def __init__(self, document: Document, renderer: Renderer) -> None:
        self.document = document
        ids = renderer.render(as_scene(document)).planes["id"].astype(np.int64)
        edge = np.zeros(ids.shape, dtype=bool)
        edge[:, 1:] |= ids[:, 1:] != ids[:, :-1]
        edge[1:, :] |= ids[1:, :] != ids[:-1, :]
        random = np.random.default_rng(20260301)
        height, width = ids.shape
        rows, columns = np.nonzero(edge)
        chosen = random.choice(len(rows), EDGES, replace=False)
        self.rows = np.concatenate([rows[chosen], random.integers(0, height, ANYWHERE)])
        self.columns = np.concatenate([columns[chosen], random.integers(0, width, ANYWHERE)])
        pixels = list(zip(self.columns.tolist(), self.rows.tolist(), strict=True))
        self.truth: Truth = Oracle(as_scene(document)).pixels(pixels)

    def planes(self, renderer: Renderer, precision: str) -> dict[str, NDArray[Any]]:
        output = {**self.document["output"], "precision": precision}
        planes = renderer.render(as_scene({**self.document, "output": output})).planes
        return {name: plane[self.rows, self.columns] for name, plane in planes.items()}


@pytest.fixture(scope="module", params=[False, True], ids=["here", "at 1e7"])
def sample(request: pytest.FixtureRequest, renderer: Renderer) -> Sample:
    return Sample(lysozyme(request.param), renderer)


@pytest.mark.parametrize(("precision", "depth_steps"), [("exact", 0), ("float64", 1)])
def test_sampled_pixels_in_binary64(sample: Sample, precision: str, depth_steps: int, renderer: Renderer) -> None:
    planes, truth = sample.planes(renderer, precision), sample.truth
    assert truth.hit.sum() > EDGES / 2
    assert not wrong_hits(planes, truth).any()
    for channel, field in DEPTHS.items():
        assert float32_steps(planes[channel], getattr(truth, field)).max() <= depth_steps, channel
    assert normal_error(planes, truth).max() <= 2.0**-23
    assert position_error(planes, truth).max() <= 1


def test_sampled_pixels_in_binary32(sample: Sample, renderer: Renderer) -> None:
    planes, truth = sample.planes(renderer, "float32"), sample.truth
    clear = truth.margin >= FLOAT32_BAND
    assert clear.mean() > 0.95
    assert not wrong_hits(planes, truth)[clear].any()
    well = clear & truth.hit & (truth.condition <= 4)
    assert well.sum() > EDGES / 4
    assert float32_steps(planes["Z"], truth.depth)[well].max() <= 4
    assert float32_steps(planes["T"], truth.distance)[well].max() <= 4
    facing = well & (truth.normal_condition <= 16)
    error = np.abs(stacked(planes, "N") - truth.normal).max(axis=-1)
    assert error[facing].max() <= 2.0**-24 * (1 + 24 * 16)
