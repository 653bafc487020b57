"""The camera in exact arithmetic: all rays as one matrix, and functions of space as seen along them."""

from typing import NamedTuple

import numpy as np
from flint import fmpq, fmpq_mat, fmpz, fmpz_mat

from conicoid.exact.planes import SeenPlane
from conicoid.exact.polynomial import Linear, Quadratic
from conicoid.exact.rationals import affine_matrix, exact, primitive
from conicoid.scene import Camera, Output


class AlongRays(NamedTuple):
    """The function offset(u, v) + slope(u, v) t, both linear, in doubled pixel coordinates."""

    offset: Linear
    slope: Linear

    def at(self, u: fmpz, v: fmpz) -> tuple[fmpz, fmpz]:
        """Offset and slope on one ray."""
        return self.offset.at(u, v), self.slope.at(u, v)


class ExactRays:
    """All rays of a camera: F + t V(u, v) for a pinhole, V(u, v) + t F for an orthographic one.

    F and the linear V are homogeneous points or directions: together a 4x4 matrix with the columns F, Vu, Vv, V1.

    Attributes:
        orthographic: which of the two it is.
        in_world, scale: that matrix in world coordinates is the integers `in_world` over `scale`.
        target_from_world: 3x4, takes world gradients (columns, with their constant) to the space of
            `output.normal_space`, times a positive number.
        position: world x, y, z and 1 along the rays, over one positive denominator.
        direction: camera x, y, z along the rays, over one positive denominator; the slopes are d.
        target: x, y, z along the rays, in the space of `output.normal_space`, over one positive denominator.
    """

    def __init__(self, camera: Camera, output: Output) -> None:
        fx, fy, cx, cy = (exact(float(value)) for value in (camera.fx, camera.fy, camera.cx, camera.cy))
        self.orthographic = camera.projection == "orthographic"
        depth, weight = ([-1, 0, 0, 0], [0, 0, 0, 1]) if self.orthographic else ([0, 0, 0, -1], [1, 0, 0, 0])
        in_camera = fmpq_mat([[0, 1 / fx, 0, -cx / fx], [0, 0, -1 / fy, cy / fy], depth, weight])
        world_from_camera = affine_matrix(camera.world_from_camera[:3])
        self.in_world, self.scale = (world_from_camera * in_camera).numer_denom()
        camera_rows, world_rows = self._along(in_camera.numer_denom()[0]), self._along(self.in_world)
        self.position, self.direction = world_rows, camera_rows[:3]
        in_target, self.target = affine_matrix(np.eye(3, 4)), world_rows[:3]
        if output.normal_space == "camera":
            in_target, self.target = world_from_camera, camera_rows[:3]
        self.target_from_world = fmpz_mat(in_target.transpose().numer_denom()[0].tolist()[:3])

    def along(self, functions: fmpz_mat) -> list[AlongRays]:
        """Affine functions of the world (rows of x, y, z and constant coefficients), times one positive number."""
        return self._along(functions * self.in_world)

    def split(self, row: list[fmpz]) -> tuple[Linear, Linear]:
        """Offset and slope of one row of a product with the matrix of rays."""
        fixed, moving = Linear(fmpz(0), fmpz(0), row[0]), Linear(*row[1:])
        return (moving, fixed) if self.orthographic else (fixed, moving)

    def planes(self, functions: fmpz_mat) -> list[SeenPlane]:
        """Affine functions of the world (rows of x, y, z and constant coefficients)."""
        return [SeenPlane(fixed, Linear(*moving)) for fixed, *moving in (functions * self.in_world).tolist()]

    def depth_beyond(self, depth: fmpq) -> SeenPlane:
        """The function t - depth."""
        zero = fmpz(0)
        offset, slope = -depth.p, depth.q
        fixed, moving = (slope, offset) if self.orthographic else (offset, slope)
        return SeenPlane(fixed, Linear(zero, zero, moving))

    def quadratic(self, form: fmpz_mat) -> tuple[Quadratic, Linear, Quadratic]:
        """a, b, c with a t^2 + 2b t + c = f scale^2, where f is the world's symmetric 4x4 form."""
        rows = (self.in_world.transpose() * form * self.in_world).tolist()
        zero = fmpz(0)
        fixed = Quadratic(zero, zero, zero, zero, zero, rows[0][0])
        mixed = Linear(*rows[0][1:])
        moving = Quadratic(rows[1][1], 2 * rows[1][2], rows[2][2], 2 * rows[1][3], 2 * rows[2][3], rows[3][3])
        return (fixed, mixed, moving) if self.orthographic else (moving, mixed, fixed)

    def _along(self, rows: fmpz_mat) -> list[AlongRays]:
        parts = [part.doubled() for row in rows.tolist() for part in self.split(row)]
        whole = primitive([value for part in parts for value in part])
        linear = [Linear(*whole[i : i + 3]) for i in range(0, len(whole), 3)]
        return [AlongRays(*pair) for pair in zip(linear[::2], linear[1::2], strict=True)]
