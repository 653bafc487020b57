"""One quadric of a scene in exact arithmetic: its form in the world, and its integers along the rays."""

from typing import Final

from flint import fmpq, fmpq_mat

from conicoid.exact.forms import ExactForms, cap_conic, discriminant
from conicoid.exact.polynomial import Integers
from conicoid.exact.rationals import affine_matrix, exact, exact_matrix, integers
from conicoid.exact.rays import ExactRays
from conicoid.scene import Quadrics
from conicoid.shapes import SHAPES

SURFACE: Final = 0
CAP_LOW: Final = 1
CAP_HIGH: Final = 2


class ExactQuadric:
    """What a ray needs to know of a quadric.

    Attributes:
        world_form: symmetric 4x4, f of the world.
        ends: the planes z - z0 and z - z1 as rows of world coefficients; none without a z_range.
        a, b, c: of f = a t^2 + 2b t + c, over one positive denominator.
        range, clips: half-spaces offset + slope t >= 0 that keep points: z0 and z1 in this order, then the clips.
        capped: whether the planes of `range` carry caps.
        gradient: x, y, z of the gradient of f in target space, over one positive denominator.
    """

    def __init__(self, rays: ExactRays, quadrics: Quadrics, index: int) -> None:
        self._rays = rays
        self._radius = exact(float(quadrics.radii[index, 2]))
        object_from_world = affine_matrix(quadrics.world_from_object[index]).inv()
        self.world_form = object_from_world.transpose() * _object_form(quadrics, index) * object_from_world
        self._forms = rays.quadratic(self.world_form)
        a, b, c = (form.doubled() for form in self._forms)
        whole = integers([*a, *b, *c])
        self.a, self.b, self.c = whole[:6], whole[6:9], whole[9:]
        self.gradient = rays.along(fmpq_mat((rays.target_from_world * self.world_form).tolist()[:3]))

        self._height = fmpq_mat([object_from_world.tolist()[2]])
        low, high = quadrics.z_range[index].tolist()
        levels = [exact(low), exact(high)] if low > float("-inf") else []
        self.ends = [self._height - fmpq_mat([[0, 0, 0, level]]) for level in levels]
        self.range = [rays.along(plane * side)[0] for plane, side in zip(self.ends, (1, -1), strict=False)]
        self.capped = bool(quadrics.capped[index])
        start, stop = quadrics.clip_start[index : index + 2].tolist()
        self.clips = [rays.along(exact_matrix(quadrics.clip[row : row + 1]))[0] for row in range(start, stop)]

    def cap_normal(self, kind: int) -> Integers:
        """Outward normal of a cap in target space, not of unit length: -z at z0, +z at z1."""
        gradient = (self._rays.target_from_world * self._height.transpose()).entries()[:3]
        return integers([-value if kind == CAP_LOW else value for value in gradient])

    def surface_key(self, kind: int) -> Integers:
        """Equation of the surface or of a cap's plane in the world; equal keys are one set of points.

        Coefficients up to a factor, as integers: four of a plane, where the equation says no more than a plane does,
        else ten of the form.
        """
        form = self.world_form.tolist()
        if kind == SURFACE:
            terms = _plane_of(form) or [form[i][j] for i in range(4) for j in range(i, 4)]
        else:
            terms = self.ends[kind - CAP_LOW].entries()
        leading = next(term for term in terms if term != 0)
        return integers([term / leading for term in terms])

    def forms(self) -> ExactForms:
        """The polynomials behind the integers, in pixels and to the scale of the scene's numbers."""
        rays, orthographic = self._rays, self._rays.orthographic
        a, b, c = self._forms
        ends, (height,) = (
            [
                tuple(part.over(self._radius) for part in rays.split((plane * rays.in_world).entries()))
                for plane in planes
            ]
            for planes in (self.ends, [self._height])
        )
        return ExactForms(
            a=a,
            b=b,
            c=c,
            s=discriminant(a, b, c, orthographic=orthographic),
            range=tuple(offset for offset, _ in ends),
            height=height[1],
            cap=tuple(cap_conic(a, b, c, *end, orthographic=orthographic) for end in ends),
        )


def _object_form(quadrics: Quadrics, index: int) -> fmpq_mat:
    """Symmetric 4x4 with f = x' form x in object space."""
    row = int(quadrics.matrix_row[index])
    if row >= 0:
        return exact_matrix(quadrics.matrix[row])
    shape = SHAPES[int(quadrics.shape[index])]
    form = fmpq_mat(4, 4)
    for axis, (square, radius) in enumerate(zip(shape.squares, quadrics.radii[index].tolist(), strict=True)):
        form[axis, axis] = square / exact(radius) ** 2
    form[2, 3] = form[3, 2] = fmpq(shape.linear_z, 2)
    form[3, 3] = fmpq(shape.constant)
    return form


def _plane_of(form: list[list[fmpq]]) -> list[fmpq] | None:
    """The plane where a form vanishes, if it is a linear function or the square of one."""
    if not any(term != 0 for row in form[:3] for term in row[:3]):
        return [2 * form[0][3], 2 * form[1][3], 2 * form[2][3], form[3][3]]
    pivot = next((row for row, line in enumerate(form) if line[row] != 0), None)
    if pivot is None:
        return None
    line = form[pivot]
    is_square = all(form[i][j] * line[pivot] == line[i] * line[j] for i in range(4) for j in range(i, 4))
    return line if is_square else None
