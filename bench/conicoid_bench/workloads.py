"""The generated scenes that every benchmark here uses: ellipsoids in a frustum, seeded, at 1920 x 1080."""

from dataclasses import replace

import numpy as np

from conicoid.scene import Camera, Floats, Output, Precision, Quadrics, Scene
from conicoid_bench.whole import ELLIPSOID, SPHERE

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


def spheres(count: int, coverage: float) -> Scene:
    """The spheres of the same volumes at the same places."""
    scene = ellipsoids(count, coverage)
    radii = np.repeat(np.cbrt(scene.quadrics.radii.prod(axis=1))[:, None], 3, axis=1)
    return _as_spheres(scene, radii)


def sphere_over(share: float) -> Scene:
    """One sphere in the middle that covers that share of the image's area, 0 to 1."""
    scene, middle = ellipsoids(1, 1.0), np.array([WIDTH, HEIGHT]) / 2
    low, high = 0.0, float(np.hypot(*middle))
    while high - low > 1e-9 * high:
        radius = (low + high) / 2
        low, high = (radius, high) if _disc_inside(radius, *middle) < share * WIDTH * HEIGHT else (low, radius)
    # The silhouette of a sphere in the middle is a circle: its rays touch where sin = r / distance.
    sine = np.sin(np.arctan(low / scene.camera.fx))
    distance = -scene.quadrics.world_from_object[:, 2, 3]
    return _as_spheres(scene, np.tile(sine * distance[:, None], 3))


def _disc_inside(radius: float, across: float, up: float) -> float:
    """Area of a disc in the middle of a rectangle, of which `across` and `up` are half of the sides."""
    x = np.linspace(0, min(radius, across), 100_001)
    return float(4 * np.trapezoid(np.minimum(np.sqrt(radius**2 - x**2), up), x))


def out_of_view(count: int) -> Scene:
    """Ellipsoids as above, but in turn behind the camera and beside the image."""
    scene = ellipsoids(count, 1.0)
    place = scene.quadrics.world_from_object.copy()
    place[::2, 2, 3] *= -1
    place[1::2, 0, 3] -= 3 * place[1::2, 2, 3]
    return replace(scene, quadrics=replace(scene.quadrics, world_from_object=place))


def _as_spheres(scene: Scene, radii: Floats) -> Scene:
    place = scene.quadrics.world_from_object.copy()
    place[:, :, :3] = np.eye(3)
    shape = np.full_like(scene.quadrics.shape, SPHERE)
    return replace(scene, quadrics=replace(scene.quadrics, shape=shape, radii=radii, world_from_object=place))


def quadrics_of(radii: Floats, centre: Floats, rotation: Floats) -> Quadrics:
    """Ellipsoids from (n, 3) radii, (n, 3) centres and (n, 3, 3) rotations."""
    count = len(radii)
    return Quadrics(
        shape=np.full(count, ELLIPSOID, dtype=np.uint8),
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
