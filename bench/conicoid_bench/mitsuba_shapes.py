"""Mitsuba 3 from PyPI, in its LLVM variant: rays in, nearest hit, normal and shape out; shapes as its documents say.

Rays and the scene with its Embree hierarchy are prepared outside the clock.
"""

from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Floats, Scene
from conicoid_bench.forms import rays_of
from conicoid_bench.picture import Job, Picture
from conicoid_bench.whole import SPHERE, more_than_whole

# Each sphere is a shape of its own; building thousands of them takes longer than all measurements.
_MOST_SPHERES: Final = 2000


class Mitsuba:
    """One of its two shapes.

    Args:
        plugin: `sphere`, one shape per sphere, or `ellipsoids`, all in one shape.
    Raises:
        ImportError: Mitsuba is not installed, or has no LLVM to run on.
    """

    def __init__(self, plugin: Literal["sphere", "ellipsoids"]) -> None:
        import drjit
        import mitsuba

        try:
            mitsuba.set_variant("llvm_ad_rgb")
            drjit.eval(mitsuba.Float([1, 2]) + 1)
        except Exception as error:  # noqa: BLE001 -- drjit raises RuntimeError, or what its driver makes of it
            raise ImportError(f"Mitsuba's LLVM variant does not run here: {str(error).splitlines()[0]}") from None
        self._plugin = plugin
        self.name = f"Mitsuba {plugin}"
        self.version = str(mitsuba.__version__)

    def why_not(self, scene: Scene) -> str | None:
        """It takes whole spheres, or ellipsoids too."""
        if self._plugin == "ellipsoids":
            return more_than_whole(scene)
        if (scene.quadrics.shape != SPHERE).any():
            return "has other shapes than spheres"
        return more_than_whole(scene) or ("has too many quadrics" if len(scene.quadrics) > _MOST_SPHERES else None)

    def prepare(self, scene: Scene) -> Job:
        """Scene and rays in binary32; directions of unit length, as Mitsuba wants them."""
        import drjit
        import mitsuba

        description = self._scene(scene)
        world: list[Any] = []
        camera = scene.camera
        u, v = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
        pixel = np.stack([u.ravel(), v.ravel(), np.ones(u.size)])
        origin, direction = (columns @ pixel for columns in rays_of(camera))
        length = np.linalg.norm(direction, axis=0)
        o = mitsuba.Point3f(*(mitsuba.Float(axis.astype(np.float32)) for axis in origin))
        d = mitsuba.Vector3f(*(mitsuba.Float(axis.astype(np.float32)) for axis in direction / length))
        drjit.eval(o, d)
        ids = np.concatenate([[0], scene.quadrics.id]).astype(np.uint32)

        def build() -> None:
            world[:] = [mitsuba.load_dict(description)]

        def run() -> Any:
            hit = world[0].ray_intersect(mitsuba.Ray3f(o, d))
            drjit.eval(hit.t, hit.n)
            drjit.sync_thread()
            return hit

        def picture(hit: Any) -> Picture:
            number = self._numbers(world[0], len(scene.quadrics))
            shape = hit.prim_index if number is None else drjit.reinterpret_array(mitsuba.UInt32, hit.shape)
            t, n, which, valid = (np.array(part) for part in (hit.t, hit.n, shape, hit.is_valid()))
            index = which if number is None else number[which]
            seen = ids[np.where(valid, index + 1, 0)].reshape(u.shape)
            # Along a ray of unit length, to planar; in binary64, so that no error is added.
            depth = np.where(valid, t / length, np.inf).astype(np.float32).reshape(u.shape)
            # Outward is facing: these shapes are convex, and seen from outside.
            normal = np.where(valid, n, 0).T.astype(np.float32)
            return Picture(depth, seen, normal.reshape(*u.shape, 3))

        build()
        return Job(run, picture, build)

    def _scene(self, scene: Scene) -> dict[str, Any]:
        import mitsuba

        quadrics = scene.quadrics
        centres, radii = quadrics.world_from_object[:, :, 3], quadrics.radii
        if self._plugin == "sphere":
            spheres = zip(centres.tolist(), radii[:, 0].tolist(), strict=True)
            shapes = {f"shape{k:07d}": {"type": "sphere", "center": centre, "radius": radius}
                      for k, (centre, radius) in enumerate(spheres)}  # fmt: skip
            return {"type": "scene", **shapes}
        parts = {"centers": centres, "scales": radii, "quaternions": quaternions(quadrics.world_from_object[:, :, :3])}
        tensors = {name: mitsuba.TensorXf(part.astype(np.float32)) for name, part in parts.items()}
        return {"type": "scene", "shape": {"type": "ellipsoids", "extent": 1.0, **tensors}}

    def _numbers(self, world: Any, count: int) -> NDArray[np.int64] | None:
        """Place in the document of each of Mitsuba's registered shapes; None where they are one."""
        import drjit
        import mitsuba

        if self._plugin != "sphere":
            return None
        registered = np.array(drjit.reinterpret_array(mitsuba.UInt32, world.shapes_dr()))
        places = [int(shape.id().removeprefix("shape")) for shape in world.shapes()]
        numbers = np.full(max(registered.max() + 1, count), -1, dtype=np.int64)
        numbers[registered] = places
        return numbers


def quaternions(rotations: Floats) -> Floats:
    """(n, 4) unit quaternions x, y, z, w of (n, 3, 3) rotations, the largest component first found and divided by."""
    xx, yy, zz = (rotations[:, k, k] for k in range(3))
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz], axis=1)

    def off(i: int, j: int, sign: int) -> Floats:
        return rotations[:, i, j] + sign * rotations[:, j, i]

    zero = np.zeros(len(rotations))
    x, y, z = (off(2, 1, -1), off(0, 2, -1), off(1, 0, -1))
    products = np.array([[zero, off(1, 0, 1), off(0, 2, 1), x], [off(1, 0, 1), zero, off(2, 1, 1), y],
                         [off(0, 2, 1), off(2, 1, 1), zero, z], [x, y, z, zero]])  # fmt: skip
    largest = squares.argmax(axis=1)
    rows = np.arange(len(rotations))
    found = products[largest, :, rows]
    found[rows, largest] = squares[rows, largest]
    unit: Floats = found / np.linalg.norm(found, axis=1, keepdims=True)
    return unit
