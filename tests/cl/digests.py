"""`python -m tests.cl.digests`: render scenes in a process of its own and print the digests of their bytes as JSON.

The driver reads its settings once in a process: device, threads and vector width can only be varied from outside.
"""

import argparse
import hashlib
import json
import sys
import tempfile
from pathlib import Path

import pytest

import conicoid.bins
from conicoid.canonical import scene_hash
from conicoid.device import DeviceInfo
from conicoid.engine import Renderer
from conicoid.scene import Scene
from conicoid_service import exr
from tests.checkout import ROOT
from tests.cl.kernel_sources import edit_kernels
from tests.scenes import CATALOGUE, as_scene
from tests.scenes.catalogue import CHANNELS
from tests.scenes.stress_catalogue import STRESS

SIZE = (480, 270)
SMALL = ("crowd", "caps_are_clipped", "camera_normals_facing", "cone_towards_eye_pinhole", "far_away_orthographic")
HARD = (
    "mix_1", "mix_2", "mix_5", "needle_1_to_1e+09", "pancake_1_to_1e+12", "coincident_parts_pinhole",
    "tangent_ball_exact", "can_of_0.001_at_1e+10", "near_double_plane_pinhole", "clip_far_from_the_origin",
    "planes_crossing_at_a_unit_orthographic", "midpoints_along_a_slope", "units_1e-30_pinhole",
    "positions_on_midpoints",
)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--lanes", type=int)
    parser.add_argument("--tile", type=int)
    arguments = parser.parse_args()
    with pytest.MonkeyPatch.context() as patch, tempfile.TemporaryDirectory() as folder:
        if arguments.lanes:
            patch.setattr(DeviceInfo, "double_lanes", arguments.lanes)
        if arguments.tile:
            edit_kernels(Path(folder), [("records.h", "#define TILE 16", f"#define TILE {arguments.tile}")], patch)
            patch.setattr(conicoid.bins, "TILE", arguments.tile)
        renderer = Renderer()
        json.dump({name: digest(renderer, scene) for name, scene in scenes().items()}, sys.stdout)


def scenes() -> dict[str, Scene]:
    lysozyme = json.loads((ROOT / "examples" / "lysozyme.json").read_bytes())
    lysozyme["camera"] |= dict(zip(("width", "height"), SIZE, strict=True))
    found = {"lysozyme": {**lysozyme, "output": {"channels": CHANNELS}}}
    found["lysozyme_front"] = {**lysozyme, "output": {"channels": ["Z", "T", "N", "P", "id"]}}
    found |= {name: CATALOGUE[name].document for name in SMALL}
    found |= {name: STRESS[name].document for name in HARD}
    return {name: as_scene(body) for name, body in found.items()}


def digest(renderer: Renderer, scene: Scene) -> dict[str, str]:
    """SHA-256 of every plane, and of the file."""
    frame = renderer.render(scene)
    parts = {name: plane.tobytes() for name, plane in frame.planes.items()}
    parts["file"] = exr.encode(frame, scene, scene_hash(scene))
    return {name: hashlib.sha256(part).hexdigest() for name, part in parts.items()}


if __name__ == "__main__":
    main()
