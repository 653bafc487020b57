"""Small scenes and frames for the service's tests, made without the parser or the engine."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.engine import Frame
from conicoid.scene import Camera, Output, Quadrics, Scene
from conicoid.shapes import SHAPES

PLANES = {
    "Z": ("Z",),
    "T": ("T",),
    "ZBack": ("ZBack",),
    "N": ("N.X", "N.Y", "N.Z"),
    "P": ("P.X", "P.Y", "P.Z"),
    "id": ("id",),
    "A": ("A",),
}
CAMERA = Camera("pinhole", 40, 30, 50.0, 50.0, 20.0, 15.0, np.eye(4), 0.0, np.inf, (0, 0, 40, 30))


def sphere() -> Quadrics:
    """One unit sphere, 3 in front of the camera."""
    return Quadrics(
        shape=np.array([SHAPES[0].code], np.uint8),
        radii=np.ones((1, 3)),
        matrix_row=np.full(1, -1, np.int32),
        matrix=np.empty((0, 4, 4)),
        world_from_object=np.eye(4)[None, :3] + [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, -3]],
        id=np.ones(1, np.uint32),
        z_range=np.array([[-np.inf, np.inf]]),
        capped=np.zeros(1, bool),
        clip=np.empty((0, 4)),
        clip_start=np.zeros(2, np.int32),
        name={},
    )


def scene(camera: Camera = CAMERA, **output: Any) -> Scene:
    return Scene(sphere(), camera, Output(**output))


def frame(of: Scene, window: tuple[int, int, int, int] | None = None, seed: int = 1) -> Frame:
    """Planes of arbitrary bits: any float32 but NaN, infinities and subnormals among them; any uint32; N in [-1, 1]."""
    x0, y0, x1, y1 = window or of.camera.crop
    random = np.random.default_rng(seed)
    planes: dict[str, NDArray[Any]] = {}
    for name in (plane for channel in of.output.channels for plane in PLANES[channel]):
        bits = random.integers(0, 2**32, (y1 - y0, x1 - x0), np.uint32)
        if name == "id":
            planes[name] = bits
        elif name.startswith("N."):
            planes[name] = random.uniform(-1, 1, bits.shape).astype(np.float32)
        else:
            floats = bits.view(np.float32)
            planes[name] = np.where(np.isnan(floats), np.float32(np.inf), floats)
    return Frame(planes, (x0, y0, x1, y1), 0.0, 0.0)


def seen_from(camera: Camera = CAMERA, **changes: Any) -> Camera:
    return replace(camera, **changes)
