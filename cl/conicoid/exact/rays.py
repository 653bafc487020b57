"""The camera in exact arithmetic: all rays as one matrix, and functions of space as seen along them."""

from typing import NamedTuple

import numpy as np
from flint import fmpq, fmpq_mat, fmpz

from conicoid.exact.polynomial import Integers, Linear, Quadratic, linear_at
from conicoid.exact.rationals import affine_matrix, exact, integers
from conicoid.scene import Camera, Output


class AlongRays(NamedTuple):
    """offset(u, v) + slope(u, v) t, both linear, with integer coefficients in doubled pixel coordinates."""

    offset: Integers
    slope: Integers

    def at(self, u: fmpz, v: fmpz) -> tuple[fmpz, fmpz]:
        """Offset and slope on one ray."""
        return linear_at(self.offset, u, v), linear_at(self.slope, u, v)


class ExactRays:
    """All rays of a camera: F + t V(u, v) for a pinhole, V(u, v) + t F for an orthographic one.

    F and the linear V are homogeneous points or directions: together a 4x4 matrix with the columns F, Vu, Vv, V1.

    Attributes:
        orthographic: which of the two it is.
        in_world: that matrix in world coordinates.
        target_from_world: takes world gradients (columns, with their constant) to the space of `output.normal_space`.
        position: world x, y, z and 1 along the rays, over one denominator.
        direction: camera x, y, z along the rays, over one denominator; the slopes are the ray's direction.
        target: x, y, z along the rays, in the space of `output.normal_space`.
    """

    def __init__(self, camera: Camera, output: Output) -> None:
        fx, fy, cx, cy = (exact(float(value)) for value in (camera.fx, camera.fy, camera.cx, camera.cy))
        self.orthographic = camera.projection == "orthographic"
        depth, weight = ([-1, 0, 0, 0], [0, 0, 0, 1]) if self.orthographic else ([0, 0, 0, -1], [1, 0, 0, 0])
        in_camera = fmpq_mat([[0, 1 / fx, 0, -cx / fx], [0, 0, -1 / fy, cy / fy], depth, weight])
        world_from_camera = affine_matrix(camera.world_from_camera[:3])
        self.in_world = world_from_camera * in_camera
        camera_rows, world_rows = self._along(in_camera), self._along(self.in_world)
        self.position, self.direction = world_rows, camera_rows[:3]
        if output.normal_space == "camera":
            self.target_from_world, self.target = world_from_camera.transpose(), camera_rows[:3]
        else:
            self.target_from_world, self.target = affine_matrix(np.eye(3, 4)), world_rows[:3]

    def along(self, covectors: fmpq_mat) -> list[AlongRays]:
        """Functions of the world (rows of x, y, z and constant coefficients) times one positive rational."""
        return self._along(covectors * self.in_world)

    def split(self, row: list[fmpq]) -> tuple[Linear, Linear]:
        """Offset and slope of one row of a product with the matrix of rays."""
        zero = fmpq(0)
        fixed, moving = Linear(zero, zero, row[0]), Linear(*row[1:])
        return (moving, fixed) if self.orthographic else (fixed, moving)

    def quadratic(self, world_form: fmpq_mat) -> tuple[Quadratic, Linear, Quadratic]:
        """a, b, c with f = a t^2 + 2b t + c, of the symmetric form of f in the world."""
        form = (self.in_world.transpose() * world_form * self.in_world).tolist()
        zero = fmpq(0)
        fixed = Quadratic(zero, zero, zero, zero, zero, form[0][0])
        mixed = Linear(*form[0][1:])
        moving = Quadratic(form[1][1], 2 * form[1][2], form[2][2], 2 * form[1][3], 2 * form[2][3], form[3][3])
        return (fixed, mixed, moving) if self.orthographic else (moving, mixed, fixed)

    def _along(self, rows: fmpq_mat) -> list[AlongRays]:
        terms = [term for row in rows.tolist() for part in self.split(row) for term in part.doubled()]
        whole = integers(terms)
        return [AlongRays(whole[i : i + 3], whole[i + 3 : i + 6]) for i in range(0, len(whole), 6)]
