"""Every pixel of the stress scenes in `exact`: hits, ids and depths are the exact image's, normals are within 2^-23."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import get_args

import pytest

from conicoid.engine import Renderer
from conicoid.scene import Channel, Scene
from tests.oracle import Truth
from tests.oracle.answers import answers
from tests.oracle.judge import report
from tests.oracle.promise import broken
from tests.scenes import CATALOGUE, as_scene
from tests.scenes.stress_catalogue import STRESS

EVERYTHING: tuple[Channel, ...] = get_args(Channel)
# Asking for the last hit of a quadric takes general records for everything; without it closed surfaces have simple
# ones. Both must be right.
# Without depths no doubt of a depth helps a doubt of a hit.
WITHOUT_DEPTH: tuple[Channel, ...] = ("id", "A")
WITHOUT_BACK = tuple(channel for channel in EVERYTHING if channel != "ZBack")


@pytest.fixture(scope="module")
def truth_of() -> Callable[[str], Truth]:
    return cache(lambda name: answers(as_scene(STRESS[name].document)))


def rendered(renderer: Renderer, scene: Scene, channels: Sequence[Channel], truth: Truth) -> None:
    """Renders and judges."""
    output = replace(scene.output, channels=tuple(channels), precision="exact", data_window="full")
    frame = renderer.render(replace(scene, output=output))
    wrong = broken(frame.planes, truth)
    seen = {**frame.planes, "exact_id": truth.id, "exact_Z": truth.depth, "exact_N": truth.normal}
    assert not wrong, "; ".join(f"{name} {report(pixels, frame.window, **seen)}" for name, pixels in wrong.items())


@pytest.mark.parametrize("name", STRESS)
def test_a_stress_scene_is_the_exact_image(name: str, renderer: Renderer, truth_of: Callable[[str], Truth]) -> None:
    scene, truth = as_scene(STRESS[name].document), truth_of(name)
    for channels in (EVERYTHING, WITHOUT_BACK, WITHOUT_DEPTH):
        rendered(renderer, scene, channels, truth)


@pytest.mark.parametrize("name", STRESS)
def test_a_stress_scene_settled_as_a_whole_is_the_exact_image(
    name: str, renderer: Renderer, truth_of: Callable[[str], Truth], monkeypatch: pytest.MonkeyPatch
) -> None:
    # These images are too small for the engine to look for common causes of their doubts, unless told to.
    monkeypatch.setattr("conicoid.settle._FEW", 0)
    scene, truth = as_scene(STRESS[name].document), truth_of(name)
    for channels in (EVERYTHING, WITHOUT_BACK, WITHOUT_DEPTH):
        rendered(renderer, scene, channels, truth)


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_catalogue_holds_without_the_last_hit(
    name: str, renderer: Renderer, exact_image: Callable[[str], Truth]
) -> None:
    rendered(renderer, as_scene(CATALOGUE[name].document), WITHOUT_BACK, exact_image(name))


def test_the_stress_scenes_hit_and_miss() -> None:
    # A catalogue of empty images would prove nothing.
    assert len(STRESS) >= 80
    assert len(STRESS.keys() & CATALOGUE.keys()) == 0
    assert all(scene.reason for scene in STRESS.values())
