"""The textbook in NumPy: quadric by quadric, all pixels of its box at once, in binary64."""

from typing import Final

import numpy as np

from conicoid.scene import Scene
from conicoid_bench.forms import forms_of, inexpressible, pixel_boxes, rays_of
from conicoid_bench.picture import Job, Picture

# Some 50 microseconds per quadric go into calls alone.
_MOST: Final = 10_000


class Vectorised:
    """NumPy float64; rays are prepared outside the clock, matrices and boxes are built.

    Args:
        most: quadrics that it takes.
    """

    name = "NumPy float64"

    def __init__(self, most: int = _MOST) -> None:
        self._most = most

    def why_not(self, scene: Scene) -> str | None:
        """It takes whole surfaces, not too many."""
        if np.isfinite(scene.quadrics.z_range).any():
            return "has ranges"
        return inexpressible(scene) or ("has too many quadrics" if len(scene.quadrics) > self._most else None)

    def prepare(self, scene: Scene) -> Job:
        """Matrices, boxes and the rays of all pixels."""
        camera, built = scene.camera, [(forms_of(scene), pixel_boxes(scene))]
        u, v = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
        pixel = np.stack([u, v, np.ones_like(u)], axis=-1)
        origin, direction = (pixel @ columns.T for columns in rays_of(camera))

        def build() -> None:
            built[0] = forms_of(scene), pixel_boxes(scene)

        def run() -> Picture:
            forms, boxes = built[0]
            depth = np.full(u.shape, np.inf)
            seen = np.zeros(u.shape, dtype=np.uint32)
            normal = np.zeros(origin.shape)
            for matrix, form, box, number in zip(forms.parameter_from_world, forms.form, boxes, forms.id, strict=True):
                window = slice(box[1], box[3]), slice(box[0], box[2])
                o, d = origin[window] @ matrix[:, :3].T + matrix[:, 3], direction[window] @ matrix[:, :3].T
                a, b, c = (d * d) @ form[:3], (o * d) @ form[:3], (o * o) @ form[:3]
                b, c = b + form[3] / 2 * d[..., 2], c + form[3] * o[..., 2] + form[4]
                with np.errstate(all="ignore"):
                    q = -(b + np.copysign(np.sqrt(b * b - a * c), b))
                    roots = np.stack([q / a, c / q])
                    t = np.where(roots > 0, roots, np.inf).min(axis=0)
                nearer = t < depth[window]
                gradient = o[nearer] + t[nearer][:, None] * d[nearer]
                gradient = gradient * form[:3] + np.array([0, 0, form[3] / 2])
                depth[window][nearer], seen[window][nearer] = t[nearer], number
                normal[window][nearer] = gradient @ matrix[:, :3]
            with np.errstate(invalid="ignore"):
                normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
            normal *= np.where((normal * direction).sum(axis=-1, keepdims=True) > 0, -1, 1)
            normal = np.nan_to_num(normal, copy=False)
            return Picture(depth.astype(np.float32), seen, normal.astype(np.float32))

        return Job(run, lambda picture: picture, build)
