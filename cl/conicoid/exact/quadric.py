"""One quadric of a scene in exact arithmetic: its form in the world, and its integers along the rays."""

from functools import cached_property
from typing import Final

from flint import fmpq, fmpq_mat, fmpz, fmpz_mat

from conicoid.exact.forms import ExactForms, RationalPolynomial, cap_conic, discriminant
from conicoid.exact.planes import FlatPiece, FlatPieces, SeenPlane, factors, plane_key
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
        return self._rays.along(self._half_spaces) if self._half_spaces.nrows() else []

    @cached_property
    def _half_spaces(self) -> fmpz_mat:
        start, stop = self._quadrics.clip_start[self._index : self._index + 2].tolist()
        return exact_matrix(self._quadrics.clip[start:stop]).numer_denom()[0]

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
        if kind != SURFACE:
            return plane_key(self._ends[kind - CAP_LOW][0].entries())
        planes = factors(self._form)[1]
        return plane_key(planes[0] if len(planes) == 1 else [self._form[i, j] for i in range(4) for j in range(i, 4)])

    def flat_pieces(self, depths: list[SeenPlane]) -> FlatPieces:
        """The sheets of a pair of planes or of one, and the caps; `depths` are half-spaces that keep points."""
        rays = self._rays
        side, planes = factors(self._form)
        ends = [end for end, _ in self._ends]
        closed = [*depths, *rays.planes(self._half_spaces)]
        within = [half_space for end, way in zip(ends, (1, -1), strict=False) for half_space in rays.planes(end * way)]
        sheets = [self._flat_piece(plane, closed + within) for plane in planes]
        caps = list[FlatPiece | None]()
        if self.capped:
            # One within a sheet is never first.
            keys = {plane_key(plane) for plane in planes}
            rows = [end.entries() for end in ends]
            caps = [None if plane_key(row) in keys else self._flat_piece(row, closed) for row in rows]
        turn, faces = None, list[list[fmpz]]()
        if len(planes) == 2:
            first, second = rays.planes(fmpz_mat(planes))
            way = -1 if rays.orthographic else 1
            turn = Linear(*[way * side * value for value in first.crossed(second)])
            # Against the slope, which has the sign of -fixed (pinhole) or fixed.
            normals = (rays.target_from_world * fmpz_mat(planes).transpose()).transpose().tolist()
            faces = [
                [way * sign(seen.fixed) * axis for axis in normal]
                for seen, normal in zip((first, second), normals, strict=True)
            ]
        return FlatPieces(sheets, caps, turn, faces)

    def _flat_piece(self, plane: list[fmpz], half_spaces: list[SeenPlane]) -> FlatPiece | None:
        (seen,) = self._rays.planes(fmpz_mat([plane]))
        # A plane through the eye, or along parallel rays, is met nowhere.
        if not seen.fixed:
            return None
        lines = [half_space.keeps(seen) for half_space in half_spaces]
        return FlatPiece(plane_key(plane), seen, [line for line in lines if any(line)])

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
