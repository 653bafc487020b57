"""One quadric of a scene in exact arithmetic: its form in the world, and its integers along the rays."""

from functools import cached_property
from typing import Final

from flint import fmpq, fmpq_mat, fmpz, fmpz_mat

from conicoid.exact.forms import ExactForms, RationalPolynomial, cap_conic, discriminant
from conicoid.exact.polynomial import Linear, Quadratic
from conicoid.exact.rationals import affine_matrix, exact, exact_matrix, primitive, sign
from conicoid.exact.rays import AlongRays, ExactRays
from conicoid.scene import Quadrics
from conicoid.shapes import SHAPES

SURFACE: Final = 0
CAP_LOW: Final = 1
CAP_HIGH: Final = 2


class ExactQuadric:
    """What a ray needs to know of a quadric.

    Attributes:
        a, b, c: of f = a t^2 + 2b t + c, over one positive denominator, in doubled pixel coordinates.
        capped: whether the planes of `range` carry caps.

    What not every pixel asks for is computed when it is first asked for.
    """

    def __init__(self, rays: ExactRays, quadrics: Quadrics, index: int) -> None:
        self._rays, self._quadrics, self._index = rays, quadrics, index
        self._object_from_world = affine_matrix(quadrics.world_from_object[index]).inv().numer_denom()
        object_from_world, scale = self._object_from_world
        object_form, form_scale = _object_form(quadrics, index).numer_denom()
        self._form = object_from_world.transpose() * object_form * object_from_world
        a, b, c = self._polynomials = rays.quadratic(self._form)
        self._scale = form_scale * (scale * rays.scale) ** 2
        whole = primitive([*a.doubled(), *b.doubled(), *c.doubled()])
        self.a, self.b, self.c = Quadratic(*whole[:6]), Linear(*whole[6:9]), Quadratic(*whole[9:])
        self.capped = bool(quadrics.capped[index])

    @cached_property
    def gradient(self) -> list[AlongRays]:
        """x, y, z of the gradient of f in target space, over one positive denominator."""
        return self._rays.along(self._rays.target_from_world * self._form)

    @cached_property
    def range(self) -> list[AlongRays]:
        """Half-spaces offset + slope t >= 0 that keep points: z0 and z1 in this order; none without a z_range."""
        return [self._rays.along(end * side)[0] for (end, _), side in zip(self._ends, (1, -1), strict=False)]

    @cached_property
    def clips(self) -> list[AlongRays]:
        """Half-spaces that keep points, as `range`."""
        start, stop = self._quadrics.clip_start[self._index : self._index + 2].tolist()
        if start == stop:
            return []
        return self._rays.along(exact_matrix(self._quadrics.clip[start:stop]).numer_denom()[0])

    # Rows of world coefficients over their denominators: X3 = z/c, and X3 - z0/c, X3 - z1/c with a z_range.

    @cached_property
    def _height(self) -> tuple[fmpz_mat, fmpz]:
        return self._over_radius.numer_denom()

    @cached_property
    def _ends(self) -> list[tuple[fmpz_mat, fmpz]]:
        low, high = self._quadrics.z_range[self._index].tolist()
        levels = [exact(low), exact(high)] if low > float("-inf") else []
        return [(self._over_radius - fmpq_mat([[0, 0, 0, level / self._radius]])).numer_denom() for level in levels]

    @cached_property
    def _radius(self) -> fmpq:
        return exact(float(self._quadrics.radii[self._index, 2]))

    @cached_property
    def _over_radius(self) -> fmpq_mat:
        object_from_world, scale = self._object_from_world
        return fmpq_mat([object_from_world.tolist()[2]]) / (scale * self._radius)

    def cap_normal(self, kind: int) -> tuple[fmpz, ...]:
        """Outward normal of a cap in target space, not of unit length: -z at z0, +z at z1."""
        upward = (self._rays.target_from_world * self._height[0].transpose()).entries()
        return tuple(-value for value in upward) if kind == CAP_LOW else tuple(upward)

    def surface_key(self, kind: int) -> tuple[fmpz, ...]:
        """Equation of the surface, or of a cap's plane, in the world; equal keys are one set of points.

        Coefficients up to a factor: four of a plane, where f is a linear function or the square of one, else ten.
        """
        if kind == SURFACE:
            form = self._form.tolist()
            terms = _plane_of(form) or [form[i][j] for i in range(4) for j in range(i, 4)]
        else:
            terms = self._ends[kind - CAP_LOW][0].entries()
        leading = next(sign(term) for term in terms if term)
        return tuple(leading * term for term in primitive(terms))

    def forms(self) -> ExactForms:
        """The polynomials behind the integers, in pixels and to the scale of the scene's numbers."""
        orthographic, scale = self._rays.orthographic, self._scale
        a, b, c = self._polynomials
        ends = [self._along_rays(*end) for end in self._ends]
        (_, slope), height_scale = self._along_rays(*self._height)
        return ExactForms(
            a=RationalPolynomial(a, scale),
            b=RationalPolynomial(b, scale),
            c=RationalPolynomial(c, scale),
            s=RationalPolynomial(discriminant(a, b, c, orthographic=orthographic), scale * scale),
            range=tuple(RationalPolynomial(plane[0], over) for plane, over in ends),
            height=RationalPolynomial(slope, height_scale),
            cap=tuple(
                RationalPolynomial(cap_conic(a, b, c, plane, orthographic=orthographic), scale * over * over)
                for plane, over in ends
            ),
        )

    def _along_rays(self, plane: fmpz_mat, scale: fmpz) -> tuple[tuple[Linear, Linear], fmpz]:
        """Offset and slope of a plane as integers, and what they are over."""
        return self._rays.split((plane * self._rays.in_world).entries()), scale * self._rays.scale


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


def _plane_of(form: list[list[fmpz]]) -> list[fmpz] | None:
    """The plane where a form vanishes, if it is a linear function or the square of one."""
    if not any(term for row in form[:3] for term in row[:3]):
        return [2 * form[0][3], 2 * form[1][3], 2 * form[2][3], form[3][3]]
    pivot = next((row for row, line in enumerate(form) if line[row]), None)
    if pivot is None:
        return None
    line = form[pivot]
    is_square = all(form[i][j] * line[pivot] == line[i] * line[j] for i in range(4) for j in range(i, 4))
    return line if is_square else None
