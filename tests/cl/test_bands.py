"""Frames whose tile lists would take too much memory are rendered in bands, with the same bytes."""

import numpy as np
import pytest

import conicoid.bins
from conicoid.engine import Frame, Renderer
from conicoid.scene import Scene
from tests.scenes import CATALOGUE, as_scene

# All are taller than a tile.
NAMES = ("crowd", "crop", "tall_image", "tight_window")


@pytest.mark.parametrize("name", NAMES)
def test_bands_change_no_byte(name: str, renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = as_scene(CATALOGUE[name].document)
    whole = renderer.render(scene)
    expected = {channel: plane.tobytes() for channel, plane in whole.planes.items()}
    bands, band = list[Frame](), renderer._band

    def noted(scene: Scene, crop: tuple[int, int, int, int]) -> Frame:
        bands.append(band(scene, crop))
        return bands[-1]

    monkeypatch.setattr(renderer, "_band", noted)
    monkeypatch.setattr(conicoid.bins, "MOST_ENTRIES", 0)
    frame = renderer.render(scene)
    assert {channel: plane.tobytes() for channel, plane in frame.planes.items()} == expected
    assert frame.window == whole.window
    assert len(bands) > 1


def test_boxes_tell_whether_lists_fit(renderer: Renderer) -> None:
    crop = (0, 0, 16384, 16384)
    everywhere = np.array([crop] * 200, dtype=np.int32)
    small = np.array([(8, 8, 24, 24)] * 2_000_000, dtype=np.int32)
    assert renderer._binning.fits(everywhere[:1], crop)
    assert renderer._binning.fits(small, crop)
    assert not renderer._binning.fits(everywhere, crop)
    strip = (0, 0, 16, 16384)
    assert not renderer._binning.fits(np.array([strip] * 200_000, dtype=np.int32), strip)
