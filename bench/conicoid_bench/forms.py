"""A scene as the baselines take it: world-to-parameter-space matrices, as any ray tracer of quadrics keeps them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Camera, Floats, Scene
from conicoid.shapes import SHAPES
from conicoid.verify import PixelBoxes
from conicoid_bench.whole import is_ball


@dataclass(frozen=True)
class Forms:
    """n quadrics in binary64, from the scene's own numbers by NumPy's arithmetic.

    Attributes:
        parameter_from_world: (n, 3, 4).
        form: (n, 5) coefficients of X^2, Y^2, Z^2, of Z, and the constant.
        z_range: (n, 2) in parameter space.
        capped: (n,) bool.
        id: (n,) uint32.
    """

    parameter_from_world: Floats
    form: Floats
    z_range: Floats
    capped: NDArray[np.bool_]
    id: NDArray[np.uint32]


def inexpressible(scene: Scene) -> str | None:
    """Why a scene cannot be written as Forms."""
    if (scene.quadrics.matrix_row >= 0).any():
        return "has general forms"
    return "has clips" if len(scene.quadrics.clip) else None


def forms_of(scene: Scene) -> Forms:
    """The forms of a scene that can be expressed."""
    quadrics = scene.quadrics
    affine = np.tile(np.eye(4), (len(quadrics), 1, 1))
    affine[:, :3] = quadrics.world_from_object
    object_from_world = np.linalg.inv(affine)[:, :3]
    table = np.array([[*shape.squares, shape.linear_z, shape.constant] for shape in SHAPES], dtype=np.float64)
    return Forms(
        object_from_world / quadrics.radii[:, :, None],
        table[quadrics.shape],
        quadrics.z_range / quadrics.radii[:, 2:],
        quadrics.capped,
        quadrics.id,
    )


def rays_of(camera: Camera) -> tuple[Floats, Floats]:
    """(3, 3) origin and (3, 3) direction of the ray of pixel coordinates (u, v), as columns of u, v, 1; world axes."""
    rotation, eye = camera.world_from_camera[:3, :3], camera.world_from_camera[:3, 3]
    across = np.array([[1 / camera.fx, 0, -camera.cx / camera.fx], [0, -1 / camera.fy, camera.cy / camera.fy],
                       [0, 0, 0]])  # fmt: skip
    forward = np.array([[0.0, 0, 0], [0, 0, 0], [0, 0, -1]])
    origin = np.zeros((3, 3))
    if camera.projection == "orthographic":
        origin = rotation @ across
        across = np.zeros((3, 3))
    origin[:, 2] += eye
    return origin, rotation @ (across + forward)


def pixel_boxes(scene: Scene) -> NDArray[np.int64]:
    """(n, 4) half-open pixel boxes [x0, y0, x1, y1) in the crop, never too small; empty for balls behind the camera."""
    x0, y0, x1, y1 = scene.camera.crop
    box = PixelBoxes(scene).box
    low = np.clip(np.nan_to_num(np.floor(box[:, :2]), nan=-np.inf), [x0, y0], [x1, y1])
    high = np.clip(np.nan_to_num(np.ceil(box[:, 2:]), nan=np.inf) + 1, [x0, y0], [x1, y1])
    high = np.where(_behind(scene)[:, None], low, high)
    return np.concatenate([low, high], axis=1).astype(np.int64)


def _behind(scene: Scene) -> NDArray[np.bool_]:
    """(n,) spheres and ellipsoids of which nothing is in front of the camera's plane, by a ball around each."""
    quadrics, pose = scene.quadrics, scene.camera.world_from_camera
    reach = np.linalg.norm(quadrics.world_from_object[:, :, :3], axis=(1, 2)) * quadrics.radii.max(axis=1)
    # Backwards is the camera's z; on a camera that is not orthonormal the plane is still the one across it.
    inverse = np.linalg.inv(pose[:3, :3])[2]
    back = (quadrics.world_from_object[:, :, 3] - pose[:3, 3]) @ inverse
    behind: NDArray[np.bool_] = back > 1.001 * reach * np.linalg.norm(inverse)
    return is_ball(scene) & behind
