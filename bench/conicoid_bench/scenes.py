"""The scenes of `conicoid bench error`, and why each is there."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from conicoid.document import parse
from conicoid.scene import Scene
from conicoid_bench.workloads import HEIGHT, WIDTH, camera, ellipsoids, spheres

_FOV_Y = 40.0
# Of length 1, and along no axis: along an axis the coordinates of rays keep more digits than elsewhere.
_DIRECTION = (0.48, 0.6, -0.64)


@dataclass(frozen=True)
class BenchScene:
    """A scene by name.

    Attributes:
        name: short, for tables.
        reason: what it is hard for.
        scene: Z and N are what is rendered.
    """

    name: str
    reason: str
    scene: Scene


def built_in(scale: float = 1.0) -> Iterator[BenchScene]:
    """The generated scenes at `scale` times 1920 x 1080."""
    size = max(16, round(WIDTH * scale)), max(16, round(HEIGHT * scale))
    sphere = {"shape": "sphere", "center": [0.03, 0.02, -4]}
    yield _document("sphere near", "nothing: every renderer should do well", [sphere], size)
    for power in range(3, 9):
        place = [10.0**power * axis for axis in _DIRECTION]
        view = {"eye": [0, 0, 0], "target": place, "up": [0, 1, 0]}
        reason = "c = |o|² − r² cancels; the same size on screen as the one nearby"
        yield _document(f"sphere at 1e{power}", reason, [{"shape": "sphere", "center": place}], size,
                        fov_y=_FOV_Y * 4 / 10.0**power, look_at=view)  # fmt: skip
    moved = [{"shape": "sphere", "center": [1e7 + 0.003, 1e7 + 0.002, 1e7 - 0.4], "radius": 0.1}]
    eye = [[1, 0, 0, 1e7], [0, 1, 0, 1e7], [0, 0, 1, 1e7], [0, 0, 0, 1]]
    yield _document("r = 0.1, all moved 1e7", "camera and sphere moved away together: nothing should change",
                    moved, size, world_from_camera=eye)  # fmt: skip
    pancake = [{"shape": "ellipsoid", "radii": [1, 1, 1e-6], "center": [0, 0, -4], "rotation": [0.5, 0.1, 0, 0.85]}]
    yield _document(
        "pancake 1 : 1e-6", "forms of very different sizes, normals that turn within a pixel", pancake, size
    )
    yield _workload("64 spheres", "a few large ones", spheres(64, 0.6), size)
    yield _workload("1,000 ellipsoids", "some behind each other", ellipsoids(1_000, 1.0), size)
    many = ellipsoids(100_000, 3.0)
    yield _workload("100,000 ellipsoids", "many small ones, far away for their size", many, size)
    yield _document("capped mix", "ranges and caps", _capped(), size)


def from_file(path: Path) -> BenchScene:
    """A user's own document."""
    return BenchScene(path.stem, "a scene document", parse(path.read_bytes()).resolve())


def _document(
    name: str, reason: str, quadrics: list[dict[str, Any]], size: tuple[int, int], fov_y: float = _FOV_Y, **pose: Any
) -> BenchScene:
    view = {"width": size[0], "height": size[1], "fov_y": fov_y, **pose}
    document = {"conicoid": 1, "quadrics": quadrics, "camera": view}
    return BenchScene(name, reason, parse(json.dumps(document).encode()).resolve())


def _workload(name: str, reason: str, scene: Scene, size: tuple[int, int]) -> BenchScene:
    return BenchScene(name, reason, replace(scene, camera=camera(*size)))


def _capped() -> list[dict[str, Any]]:
    turned = [0.3, 0.2, 0.1, 0.93]
    ends: dict[str, Any] = {"z_range": [-0.5, 0.5], "capped": True, "rotation": turned}
    return [
        {"shape": "cylinder", "radius": 0.4, "center": [-1.5, 0.6, -5], **ends},
        {"shape": "cone", "radius": 0.8, "center": [0, 0.6, -5], **ends},
        {"shape": "hyperboloid_one_sheet", "radii": [0.3, 0.3, 0.4], "center": [1.5, 0.6, -5], **ends},
        {"shape": "paraboloid", "radius": 0.7, "center": [-1.5, -0.6, -5], **ends},
        {"shape": "sphere", "radius": 0.6, "center": [0, -0.6, -5], "z_range": [-0.3, 0.2], "capped": True},
        {"shape": "ellipsoid", "radii": [0.5, 0.3, 0.6], "center": [1.5, -0.6, -5], **ends},
        {"shape": "parallel_planes", "radius": 3, "center": [0, 0, -9], "z_range": [-4, 4]},
    ]
