"""A camera as OpenEXR's standard attributes `worldToCamera` and `worldToNDC`.

Conventions of ImfStandardAttributes.h: points are row vectors, so a translation is in the last row; the camera is
left-handed (+x right, +y up, +z the viewing direction); NDC (0, 0) is the upper left and (1, 1) the lower right
corner of the display window. `docs/exr.md` works an example.
"""

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Camera

# Exact rationals: these matrices are made once per image, and nothing then needs a tolerance but their last rounding.
Exact = NDArray[np.object_]


def world_to_camera(camera: Camera) -> NDArray[np.float32]:
    """(4, 4) float32, each entry the exact one rounded; p_camera = (x, y, z, 1) @ matrix."""
    return _rounded(_world_to_camera(camera))


def world_to_ndc(camera: Camera) -> NDArray[np.float32]:
    """(4, 4) float32, each entry the exact one rounded; (x, y, z, w) = (p_world, 1) @ matrix, NDC = (x/w, y/w).

    OpenEXR leaves z open. Here z/w is 1/depth for a pinhole and the depth itself for an orthographic camera, so that
    the matrix is invertible without near and far planes.
    """
    return _rounded(_world_to_camera(camera) @ _camera_to_ndc(camera))


def _world_to_camera(camera: Camera) -> Exact:
    world_from_camera = _exact(camera.world_from_camera)
    inverse = _affine_inverse(world_from_camera)
    matrix: Exact = inverse.T * _exact([1, 1, -1, 1])  # OpenGL's camera looks down -z, OpenEXR's down +z
    return matrix


def _camera_to_ndc(camera: Camera) -> Exact:
    width, height = Fraction(camera.width), Fraction(camera.height)
    x, y = Fraction(camera.fx) / width, -Fraction(camera.fy) / height
    x_center, y_center = Fraction(camera.cx) / width, Fraction(camera.cy) / height
    if camera.projection == "orthographic":
        return _exact([[x, 0, 0, 0], [0, y, 0, 0], [0, 0, 1, 0], [x_center, y_center, 0, 1]])
    return _exact([[x, 0, 0, 0], [0, y, 0, 0], [x_center, y_center, 0, 1], [0, 0, 1, 0]])


def _affine_inverse(matrix: Exact) -> Exact:
    """Inverse of a (4, 4) affine matrix (column vectors), by the adjugate of its linear part."""
    columns = matrix[:3, 0], matrix[:3, 1], matrix[:3, 2]
    adjugate = np.stack([_cross(columns[(i + 1) % 3], columns[(i + 2) % 3]) for i in range(3)])
    linear = adjugate / (columns[0] @ adjugate[0])
    inverse = _exact(np.eye(4))
    inverse[:3, :3] = linear
    inverse[:3, 3] = -(linear @ matrix[:3, 3])
    return inverse


def _cross(a: Exact, b: Exact) -> Exact:
    return np.array([a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)], object)


def _exact(values: Any) -> Exact:
    exact: Exact = np.vectorize(Fraction, otypes=[object])(values)
    return exact


def _rounded(matrix: Exact) -> NDArray[np.float32]:
    # By way of binary64; an entry beyond binary32 becomes inf, which NumPy would warn about.
    with np.errstate(over="ignore"):
        return matrix.astype(np.float64).astype(np.float32)
