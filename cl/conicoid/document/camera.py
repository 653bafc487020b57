"""Derived camera numbers: focal lengths and poses, each by a fixed sequence of binary64 operations.

Every +, -, *, / and square root below is one correctly rounded operation in the order written (NumPy's elementwise
ufuncs, which never fuse two of them), scalings are by powers of two, and the tangent is correctly rounded: the numbers
are the same on every machine. docs/scene.md gives the same sequences for users.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.document.tangent import tan_half
from conicoid.document.variants import Group
from conicoid.scene import Camera, Floats, Projection

_LEAST_SINE2: Final = 2.0**-60


def focal_from_angle(size: NDArray[np.int64], degrees: Floats) -> Floats:
    """Focal length size / (2 tan(degrees / 2)) in pixels, (n,); inf where it overflows."""
    tangent = np.array([tan_half(angle) for angle in degrees.tolist()])
    with np.errstate(divide="ignore", over="ignore"):
        focal: Floats = size / (2 * tangent)
    return focal


def focal_from_height(size: NDArray[np.int64], view_height: Floats) -> Floats:
    """Pixels per world unit, (n,); inf where it overflows."""
    with np.errstate(over="ignore"):
        focal: Floats = size / view_height
    return focal


def look_at_pose(eye: Floats, target: Floats, up: Floats) -> Floats:
    """world_from_camera of views from `eye` to `target`, each (n, 3): (n, 4, 4) in OpenGL axes.

    z = eye - target, x = up cross z, y = z cross x; up and each axis are normalised before they are used.
    """
    z = _backward(eye, target)
    x = _normalised(_cross(_normalised(up), z))
    y = _normalised(_cross(z, x))
    pose = np.zeros((len(eye), 4, 4))
    pose[:, :3, 0], pose[:, :3, 1], pose[:, :3, 2], pose[:, :3, 3] = x, y, z, eye
    pose[:, 3, 3] = 1
    return pose + 0.0


def is_across(eye: Floats, target: Floats, up: Floats) -> NDArray[np.bool_]:
    """Whether `up` is at least an angle of about 2^-30 away from the line of sight, (n,).

    A cross product of unit vectors is right to 4u, u = 2^-53; over a sine of 2^-30 that leaves x and z perpendicular
    to 5e-7, within the 1e-6 that `world_from_camera` is held to.
    """
    with np.errstate(invalid="ignore"):  # 0 / 0 where eye is target: not across either
        x, y, z = _cross(_normalised(up), _backward(eye, target)).T
    across: NDArray[np.bool_] = (x * x + y * y) + z * z >= _LEAST_SINE2
    return across


def _backward(eye: Floats, target: Floats) -> Floats:
    """The camera's z axis, (n, 3)."""
    with np.errstate(over="ignore"):
        z = eye - target
    # Where the difference overflows, a quarter of it does not, and only its direction counts.
    return _normalised(np.where(np.isfinite(z).all(axis=1, keepdims=True), z, 0.25 * eye - 0.25 * target))


def _normalised(vectors: Floats) -> Floats:
    """Vectors (n, 3) over their lengths.

    They are first scaled by the power of two that brings the largest component into [1/2, 1): no square overflows, and
    none that counts underflows.
    """
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    x, y, z = np.ldexp(vectors, -np.frexp(largest)[1]).T
    length = np.sqrt((x * x + y * y) + z * z)
    return np.stack([x / length, y / length, z / length], axis=1)


def _cross(p: Floats, q: Floats) -> Floats:
    (a, b, c), (d, e, f) = p.T, q.T
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)


def opengl_pose(pose: Floats) -> Floats:
    """world_from_camera in OpenCV axes (+z forward, +y down) to OpenGL's: the y and z columns change sign, exactly."""
    flipped: Floats = pose * np.array([1.0, -1.0, -1.0, 1.0]) + 0.0
    return flipped


def resolve_cameras(group: Group) -> list[Camera]:
    """The cameras of a group with every number derived and every default filled in."""
    columns = group.columns
    width, height = columns["width"], columns["height"]
    nothing = np.zeros_like(width)
    fx, fy = _focal_lengths(columns)
    cx, cy = columns.get("cx", width / 2), columns.get("cy", height / 2)
    poses = _poses(columns)
    near, far = columns.get("near", nothing), columns.get("far", np.full(len(width), np.inf))
    crop = columns.get("crop", np.stack([nothing, nothing, width, height], axis=1))
    projection: Projection = "orthographic" if group.variant == "orthographic" else "pinhole"
    return [
        Camera(
            projection=projection,
            width=int(width[k]),
            height=int(height[k]),
            fx=float(fx[k]),
            fy=float(fy[k]),
            cx=float(cx[k]),
            cy=float(cy[k]),
            world_from_camera=poses[k],
            near=float(near[k]),
            far=float(far[k]),
            crop=tuple(crop[k].tolist()),
        )
        for k in range(len(width))
    ]


def _focal_lengths(columns: dict[str, Any]) -> tuple[Floats, Floats]:
    if "fx" in columns:
        return columns["fx"], columns["fy"]
    if "fov_y" in columns:
        focal = focal_from_angle(columns["height"], columns["fov_y"])
    elif "fov_x" in columns:
        focal = focal_from_angle(columns["width"], columns["fov_x"])
    else:
        focal = focal_from_height(columns["height"], columns["view_height"])
    return focal, focal


def _poses(columns: dict[str, Any]) -> Floats:
    if "look_at" in columns:
        return look_at_pose(**columns["look_at"])
    n = len(columns["width"])
    poses: Floats = columns.get("world_from_camera", np.tile(np.eye(4), (n, 1, 1)))
    opencv = np.array(columns.get("convention", ["opengl"] * n)) == "opencv"
    return np.where(opencv[:, None, None], opengl_pose(poses), poses)
