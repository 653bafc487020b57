"""Which quadrics a pixel may see: their bounding boxes on the image, in plain binary64 with room to spare."""

import numpy as np

from conicoid.extent import ELLIPSOID, UNBOUNDED, extent_of
from conicoid.scene import Camera, Floats, Scene

# Some 40 roundings lead to a box, each within 2^-53 of the terms it is made of.
_SLACK = 2.0**-40


class PixelBoxes:
    """Conservative pixel boxes of a scene's quadrics.

    Attributes:
        box: (n, 4) float64, lowest column and row, highest column and row; infinite, or NaN, where there is no bound:
            what is unbounded, or around the eye, is everywhere.
    """

    def __init__(self, scene: Scene) -> None:
        with np.errstate(all="ignore"):  # what overflows is everywhere
            low, high = _in_camera(scene)
            self.box = _projected(scene.camera, low, high)
        self._row = -1
        self._in_row = np.empty(0, dtype=np.intp)

    def at(self, i: int, j: int) -> list[int]:
        """Indices, ascending, of the quadrics that may be seen at column i, row j; quickest row by row."""
        if j != self._row:
            # Comparisons so that NaN stays.
            self._in_row = np.flatnonzero(~((self.box[:, 1] > j) | (self.box[:, 3] < j)))
            self._row = j
        box = self.box[self._in_row]
        found: list[int] = self._in_row[~((box[:, 0] > i) | (box[:, 2] < i))].tolist()
        return found


def _in_camera(scene: Scene) -> tuple[Floats, Floats]:
    """(n, 3) lowest and highest x, y, depth of every quadric in camera axes, depth forwards; infinite or NaN if not."""
    extent = extent_of(scene.quadrics)
    pose = scene.camera.world_from_camera
    camera_from_world = np.linalg.inv(pose[:3, :3])
    camera_from_world[2] *= -1
    linear, shift = scene.quadrics.world_from_object[:, :, :3], scene.quadrics.world_from_object[:, :, 3]
    middle = np.einsum("nij,nj->ni", linear, extent.centre) + shift - pose[:3, 3]
    # The terms behind `middle`, for its rounding errors.
    terms = np.einsum("nij,nj->ni", np.abs(linear), np.abs(extent.centre)) + np.abs(shift) + np.abs(pose[:3, 3])
    axes = np.abs(camera_from_world @ linear) * extent.half[:, None, :]
    half = np.where((extent.kind == ELLIPSOID)[:, None], np.sqrt((axes**2).sum(axis=2)), axes.sum(axis=2))
    # A turned axis may nearly vanish; the errors go with what it was made of.
    size = np.einsum("ij,njk->nik", np.abs(camera_from_world), np.abs(linear)) @ extent.half[:, :, None]
    half += _SLACK * (size[:, :, 0] + terms @ np.abs(camera_from_world).T)
    half[extent.kind == UNBOUNDED] = np.inf
    centre = middle @ camera_from_world.T
    return centre - half, centre + half


def _projected(camera: Camera, low: Floats, high: Floats) -> Floats:
    """(n, 4) lowest column, lowest row, highest column, highest row, one pixel wider than what is seen."""
    scale, offset = np.array([camera.fx, -camera.fy]), np.array([camera.cx, camera.cy])
    sides = np.stack([low[:, :2], high[:, :2]])
    if camera.projection == "pinhole":
        depths = np.stack([low[:, 2], high[:, 2]])
        corners = (sides[:, None] / depths[None, :, :, None]).reshape(4, -1, 2)
    else:
        corners = sides
    places = corners * scale + offset - 0.5
    box = np.concatenate([places.min(axis=0) - 1, places.max(axis=0) + 1], axis=1)
    if camera.projection == "pinhole":
        box[~(low[:, 2] > 0)] = np.array([-np.inf, -np.inf, np.inf, np.inf])
    return box
