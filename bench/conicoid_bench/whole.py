"""Scenes of whole spheres and ellipsoids seen from the origin, which is all that the fastest peers take."""

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Floats, Scene
from conicoid.shapes import SHAPES

SPHERE, ELLIPSOID = ([shape.name for shape in SHAPES].index(name) for name in ("sphere", "ellipsoid"))


def is_ball(scene: Scene) -> NDArray[np.bool_]:
    """(n,) which are spheres or ellipsoids."""
    return np.isin(scene.quadrics.shape, [SPHERE, ELLIPSOID])


def more_than_whole(scene: Scene) -> str | None:
    """Why a scene is more than whole, rotated ellipsoids; None if it is not."""
    quadrics = scene.quadrics
    if not is_ball(scene).all():
        return "has other shapes"
    if np.isfinite(quadrics.z_range).any() or len(quadrics.clip):
        return "has ranges or clips"
    linear = quadrics.world_from_object[:, :, :3]
    if np.abs(linear @ linear.swapaxes(1, 2) - np.eye(3)).max() > 1e-6:
        return "has sheared or scaled quadrics"
    return None


def moved_camera(scene: Scene) -> str | None:
    """Why the rays are not those of a pinhole at the origin that looks down -z at the whole image."""
    camera = scene.camera
    plain = camera.projection == "pinhole" and np.array_equal(camera.world_from_camera, np.eye(4))
    return None if plain and camera.crop == (0, 0, camera.width, camera.height) else "has another camera"


def records(scene: Scene) -> Floats:
    """(n, 15) float64: centre, radii, and the rotation's rows, in camera axes."""
    quadrics = scene.quadrics
    rotation = quadrics.world_from_object[:, :, :3].reshape(-1, 9)
    return np.concatenate([quadrics.world_from_object[:, :, 3], quadrics.radii, rotation], axis=1)
