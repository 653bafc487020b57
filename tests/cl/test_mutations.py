"""Faults put into the kernels on purpose are noticed: by the start-up probe, by an error bound, or by a wrong pixel."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyopencl
import pytest

from conicoid.engine import Renderer
from conicoid.errors import DeviceError
from conicoid.exact import ExactScene
from conicoid.scene import Channel
from tests.cl.bounds_probe import BoundsProbe, sample
from tests.cl.kernel_sources import Edit, edit_kernels
from tests.oracle import Truth
from tests.oracle.answers import answers
from tests.oracle.promise import broken
from tests.scenes import as_scene
from tests.scenes.stress_catalogue import STRESS

# What each fault of the second table turns wrong, and a few to show that the sound kernels pass.
SCENES = (
    "cylinder_along_the_view", "flat_cans_bare", "leaning_on_a_midpoint_even", "leaning_on_near_odd",
    "pancake_1_to_1e+06_edge_on", "needle_1_to_1e+06_along_the_view", "balls_a_unit_apart_orthographic",
    "tangent_ball_pinhole_exact", "midpoints_of_balls", "normals_on_midpoints_above", "mix_2",
)  # fmt: skip
CHANNELS: tuple[tuple[Channel, ...], ...] = (
    ("Z", "T", "ZBack", "N", "P", "id", "A"),
    ("Z", "T", "N", "P", "id", "A"),
    ("id", "A"),
)

REASONS = "int reasons = (int)(doubt & 0xff)"

# Bounds are derived, not tuned: errors that are a sixteenth of what is allowed do occur, but seldom where a pixel
# hangs by them. So bounds are held against errors.
BOUNDS: dict[str, list[Edit]] = {
    "every bound over 16": [("records.h", "#define UNIT_ROUNDOFF 0x1p-53", "#define UNIT_ROUNDOFF 0x1p-57")],
    "no bounds": [("records.h", "#define UNIT_ROUNDOFF 0x1p-53", "#define UNIT_ROUNDOFF 0x1p-100")],
    "polynomials' bounds over 16": [("polynomials.h", "#define CHAIN (15.0", "#define CHAIN (15.0 / 16.0")],
    "no bounds of polynomials": [("polynomials.h", "#define CHAIN (15.0", "#define CHAIN (0x1p-60")],
}
SIMPLE_S = "r->s_error = in_range ? bound(AT(s_error, lane))"
PIXELS: dict[str, list[Edit]] = {
    "no bound of a simple S": [("simple_forms.h", SIMPLE_S, "r->s_error = in_range ? 0.0")],
    "no clearance of a simple root": [("simple.h", "8.01 * r->s_error", "0 * r->s_error")],
    "no bounds": BOUNDS["no bounds"],
    "no bounds of polynomials": BOUNDS["no bounds of polynomials"],
    "strips two pixels too narrow": [("slabs.cl", "low -= slack + 1e-6 * (high - low)", "low += 2.0")],
    "hits hidden too soon": [("general.h", "(real)(1 + 1e-6) / bar", "(real)0.5 / bar")],
    "no depth within reach": [("extents.h", "s.low * (real)(1 - 1e-5) > s.high", "s.low > 0.5 * s.high")],
    "no doubts": [("certify.h", REASONS, "int reasons = 0 * (int)(doubt & 0xff)")],
    "no doubts of hits": [("certify.h", REASONS, f"{REASONS} & ~DOUBT_HIT")],
    "no doubts of depths": [("certify.h", REASONS, f"{REASONS} & ~DOUBT_VALUE")],
    "no doubts of normals": [("certify.h", REASONS, f"{REASONS} & ~DOUBT_NORMAL")],
}


VALUES: tuple[tuple[str, Channel, list[Edit]], ...] = (
    ("positions_on_midpoints", "P", [("certify.h", REASONS, f"{REASONS} & ~DOUBT_POSITION")]),
    ("normals_on_midpoints_a_hair_above", "N",
     [("refine.cl", "fabs((hi - nearest) + lo) + error", "fabs(hi - nearest) - 0x1p-50")]),
)  # fmt: skip


@cache
def truth_of(name: str) -> Truth:
    return answers(as_scene(STRESS[name].document))


def wrong_scenes(renderer: Renderer) -> list[str]:
    """The scenes of SCENES that are not the exact image."""
    wrong = []
    for name in SCENES:
        scene = as_scene(STRESS[name].document)
        for channels in CHANNELS:
            frame = renderer.render(replace(scene, output=replace(scene.output, channels=channels)))
            if broken(frame.planes, truth_of(name)):
                wrong.append(f"{name}: {' '.join(channels)}")
    return wrong


@pytest.fixture
def renderer_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Sequence[Edit]], Renderer]:
    def build(edits: Sequence[Edit]) -> Renderer:
        edit_kernels(tmp_path / "edited", edits, monkeypatch)
        return Renderer()

    return build


def test_the_kernels_as_they_are_pass(renderer_of: Callable[[Sequence[Edit]], Renderer]) -> None:
    assert wrong_scenes(renderer_of([])) == []


@pytest.mark.parametrize("fault", PIXELS)
def test_a_fault_is_seen_in_the_image(fault: str, renderer_of: Callable[[Sequence[Edit]], Renderer]) -> None:
    assert wrong_scenes(renderer_of(PIXELS[fault]))


@pytest.mark.parametrize("sound", [True, False])
@pytest.mark.parametrize(("name", "channel", "fault"), VALUES)
def test_a_fault_is_seen_beside_the_exact_values(
    name: str, channel: Channel, fault: list[Edit], *, sound: bool, renderer_of: Callable[[Sequence[Edit]], Renderer]
) -> None:
    """Half a step either way is as near, so that no bound tells a tie: only the very values do."""
    scene = as_scene(STRESS[name].document)
    scene = replace(scene, output=replace(scene.output, channels=(channel,)))
    planes = renderer_of([] if sound else fault).render(scene).planes
    exact = ExactScene(scene)
    wrong = [
        (x, y)
        for y, x in np.ndindex(planes[f"{channel}.X"].shape)
        if exact.values(x, y, [0], (channel,)) != {name: plane[y, x] for name, plane in planes.items()}
    ]
    assert (not wrong) == sound


@pytest.mark.parametrize("fault", BOUNDS)
def test_errors_go_beyond_a_bound_that_is_too_small(fault: str, tmp_path: Path) -> None:
    probe = BoundsProbe(tmp_path / "edited", BOUNDS[fault])
    sample(probe, range(3), per_quadric=16)
    assert probe.beyond > 0


def test_a_product_without_fma_is_refused(renderer_of: Callable[[Sequence[Edit]], Renderer]) -> None:
    with pytest.raises(DeviceError, match="fma"):
        renderer_of([("dd.h", "fma(a, b, -p)", "a * b - p")])


def test_contraction_is_refused(renderer_of: Callable[[Sequence[Edit]], Renderer]) -> None:
    with pytest.raises(DeviceError, match="fma"):
        renderer_of([("dd.h", "typedef struct", "#pragma OPENCL FP_CONTRACT ON\ntypedef struct")])


def test_relaxed_mathematics_goes_beyond_the_bounds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build = pyopencl.Program.build

    def relaxed(program: pyopencl.Program, options: Sequence[str], **keys: Any) -> pyopencl.Program:
        built: pyopencl.Program = build(program, [*options, "-cl-fast-relaxed-math"], **keys)
        return built

    monkeypatch.setattr(pyopencl.Program, "build", relaxed)
    probe = BoundsProbe(tmp_path / "relaxed")
    sample(probe, range(3), per_quadric=16)
    assert probe.beyond > 0
