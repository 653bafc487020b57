"""A camera as OpenEXR's standard attributes `worldToCamera` and `worldToNDC`.

Conventions of ImfStandardAttributes.h: points are row vectors, so a translation is in the last row; the camera is
left-handed (+x right, +y up, +z the viewing direction); NDC (0, 0) is the upper left and (1, 1) the lower right
corner of the display window. `docs/exr.md` works an example.
"""

import numpy as np
from flint import fmpq_mat
from numpy.typing import NDArray

from conicoid.exact.rationals import affine_matrix, exact, nearest
from conicoid.scene import Camera

# Matrices of exact rationals: nothing then needs a tolerance but the last rounding.
_LEFT_HANDED = fmpq_mat(4, 4, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1])


def world_to_camera(camera: Camera) -> NDArray[np.float32]:
    """(4, 4) float32, each entry the exact one rounded; p_camera = (x, y, z, 1) @ matrix."""
    return _rounded(_world_to_camera(camera))


def world_to_ndc(camera: Camera) -> NDArray[np.float32]:
    """(4, 4) float32, each entry the exact one rounded; (x, y, z, w) = (p_world, 1) @ matrix, NDC = (x/w, y/w).

    OpenEXR leaves z open. Here z/w is 1/depth for a pinhole and the depth itself for an orthographic camera, so that
    the matrix is invertible without near and far planes.
    """
    return _rounded(_world_to_camera(camera) * _camera_to_ndc(camera))


def _world_to_camera(camera: Camera) -> fmpq_mat:
    camera_from_world = affine_matrix(camera.world_from_camera[:3]).inv()
    return camera_from_world.transpose() * _LEFT_HANDED  # OpenGL's camera looks down -z, OpenEXR's down +z


def _camera_to_ndc(camera: Camera) -> fmpq_mat:
    fx, fy, cx, cy = (exact(float(value)) for value in (camera.fx, camera.fy, camera.cx, camera.cy))
    x, y, x_center, y_center = fx / camera.width, -fy / camera.height, cx / camera.width, cy / camera.height
    if camera.projection == "orthographic":
        return fmpq_mat(4, 4, [x, 0, 0, 0, 0, y, 0, 0, 0, 0, 1, 0, x_center, y_center, 0, 1])
    return fmpq_mat(4, 4, [x, 0, 0, 0, 0, y, 0, 0, x_center, y_center, 0, 1, 0, 0, 1, 0])


def _rounded(matrix: fmpq_mat) -> NDArray[np.float32]:
    # By way of binary64; an entry beyond binary32 becomes inf, which NumPy would warn about.
    with np.errstate(over="ignore"):
        return np.array([nearest(entry) for entry in matrix.entries()]).reshape(4, 4).astype(np.float32)
