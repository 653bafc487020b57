"""A camera as the kernels see it: rays in world space, affine in the pixel, in double-double.

The ray of pixel coordinates (u, v) is point(u, v) + t direction(u, v), each p0 + u pu + v pv. Everything here is
computed in exact rationals from the camera's binary64 numbers and rounded once to double-double.
"""

from dataclasses import dataclass

import numpy as np
from flint import fmpq, fmpq_mat

from conicoid.errors import CameraRangeError
from conicoid.exact.rationals import exact, exact_matrix, nearest
from conicoid.scene import Camera, Floats, Output


@dataclass(frozen=True)
class View:
    """Constants of one frame.

    Attributes:
        orthographic: rays are parallel; else they meet in one point.
        rays: (6, 3, 2) float64 double-doubles (hi, lo): point 1, u, v, then direction 1, u, v; world axes.
        image_rows: (3, 3) float64, rows of camera_from_world's linear part scaled to pixels: u, v (v down,
            both relative to the principal point, times depth for a pinhole) and depth.
        origin: (3,) float64, the camera's place in the world.
        principal: (2,) float64, cx, cy.
        target: (3, 3) float64: a normal in target space is target^T times the world gradient.
        back: (3, 3) float64: unnormalised direction in target space, columns u, v, 1.
    """

    orthographic: bool
    rays: Floats
    image_rows: Floats
    origin: Floats
    principal: Floats
    target: Floats
    back: Floats


def view_of(camera: Camera, output: Output) -> View:
    """The frame's constants; `output.normal_space` chooses the target frame of normals.

    Raises:
        CameraRangeError: some of them are beyond binary64.
    """
    try:
        return _view_of(camera, output)
    except OverflowError:
        raise CameraRangeError(
            "the camera's rays have components beyond 1.8e308; give focal lengths and a principal point nearer to the "
            "image's size in pixels"
        ) from None


def _view_of(camera: Camera, output: Output) -> View:
    linear = exact_matrix(camera.world_from_camera[:3, :3])
    right, up, back = ([linear[i, k] for i in range(3)] for k in range(3))
    origin = [exact(value) for value in camera.world_from_camera[:3, 3].tolist()]
    fx, fy, cx, cy = (exact(float(value)) for value in (camera.fx, camera.fy, camera.cx, camera.cy))

    across = [x / fx for x in right]
    down = [-y / fy for y in up]
    corner = [-x * cx - y * cy for x, y in zip(across, down, strict=True)]
    forward = [-z for z in back]
    zero = [fmpq(0)] * 3
    if camera.projection == "orthographic":
        point = ([o + x for o, x in zip(origin, corner, strict=True)], across, down)
        direction = (forward, zero, zero)
    else:
        point = (origin, zero, zero)
        direction = ([x + z for x, z in zip(corner, forward, strict=True)], across, down)
    rays = np.array([[_double_double(x) for x in vector] for vector in point + direction])

    image_from_world = fmpq_mat(3, 3, [fx, 0, 0, 0, -fy, 0, 0, 0, -1]) * linear.inv()
    world_back = -rays[3:, :, 0].T[:, [1, 2, 0]]
    in_camera = output.normal_space == "camera"
    camera_direction = np.array([[1 / camera.fx, 0, -camera.cx / camera.fx],
                                 [0, -1 / camera.fy, camera.cy / camera.fy], [0, 0, -1]])  # fmt: skip
    if camera.projection == "orthographic":
        camera_direction[:2] = 0
    return View(
        orthographic=camera.projection == "orthographic",
        rays=rays,
        image_rows=np.array([nearest(x) for x in image_from_world.entries()]).reshape(3, 3),
        origin=camera.world_from_camera[:3, 3],
        principal=np.array([camera.cx, camera.cy]),
        target=camera.world_from_camera[:3, :3] if in_camera else np.eye(3),
        back=-camera_direction if in_camera else world_back,
    )


def _double_double(value: fmpq) -> tuple[float, float]:
    hi = nearest(value)
    return hi, nearest(value - exact(hi))
