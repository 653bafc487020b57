"""The generated scenes that every benchmark here uses: ellipsoids in a frustum, seeded, at 1920 x 1080."""

import numpy as np

from conicoid.scene import Camera, Floats, Output, Precision, Quadrics, Scene
from conicoid.shapes import SHAPES

WIDTH, HEIGHT = 1920, 1080


def camera(width: int = WIDTH, height: int = HEIGHT) -> Camera:
    """A pinhole at the origin with a 50 degree field of view, looking down -z."""
    focal = float(height / (2 * np.tan(np.radians(25))))
    return Camera("pinhole", width, height, focal, focal, width / 2, height / 2, np.eye(4), 0.0, np.inf,
                  (0, 0, width, height))  # fmt: skip


def ellipsoids(count: int, coverage: float, precision: Precision = "exact", seed: int = 7) -> Scene:
    """`count` ellipsoids that together cover `coverage` of the image, were they not to overlap.

    Depths are 10 to 100; axes differ by up to 2:1 and are turned at random. `count` = 1 is a sphere in the middle.
    """
    rng = np.random.default_rng(seed)
    view = camera()
    depth = np.cbrt(rng.uniform(10.0**3, 100.0**3, count))
    pixels = np.sqrt(coverage * WIDTH * HEIGHT / (np.pi * count))
    radius = pixels * depth / view.fx
    shape = rng.uniform(0.7, 1.4, (count, 3)) if count > 1 else np.ones((1, 3))
    u, v = rng.uniform(0, WIDTH, count), rng.uniform(0, HEIGHT, count)
    if count == 1:
        u[:], v[:] = WIDTH / 2, HEIGHT / 2
    centre = np.stack([(u - view.cx) / view.fx * depth, -(v - view.cy) / view.fy * depth, -depth], axis=1)
    return Scene(quadrics_of(radius[:, None] * shape, centre, _rotations(rng, count)), view,
                 Output(precision=precision))  # fmt: skip


def quadrics_of(radii: Floats, centre: Floats, rotation: Floats) -> Quadrics:
    """Ellipsoids from (n, 3) radii, (n, 3) centres and (n, 3, 3) rotations."""
    count = len(radii)
    code = next(shape.code for shape in SHAPES if shape.name == "ellipsoid")
    return Quadrics(
        shape=np.full(count, code, dtype=np.uint8),
        radii=radii,
        matrix_row=np.full(count, -1, dtype=np.int32),
        matrix=np.empty((0, 4, 4)),
        world_from_object=np.concatenate([rotation, centre[:, :, None]], axis=2),
        id=np.arange(1, count + 1, dtype=np.uint32),
        z_range=np.tile([-np.inf, np.inf], (count, 1)),
        capped=np.zeros(count, dtype=np.bool_),
        clip=np.empty((0, 4)),
        clip_start=np.zeros(count + 1, dtype=np.int32),
        name={},
    )


def _rotations(rng: np.random.Generator, count: int) -> Floats:
    quaternion = rng.normal(size=(4, count))
    x, y, z, w = quaternion / np.linalg.norm(quaternion, axis=0)
    return np.stack(
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
         2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
         2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=1).reshape(count, 3, 3)  # fmt: skip
