"""One quadric seen by one camera: everything a pixel needs, as integer polynomials, set up once.

On the ray of pixel p the surface is A t² + 2B t + C = 0, and every half-space (near, far, z_range, clip) is
e + g t >= 0. A, B, C are quadratic in p, e and g linear; a positive common factor is free to choose.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from flint import fmpq, fmpq_mat, fmpz

from conicoid.scene import Quadrics
from conicoid.shapes import SHAPES
from tests.oracle.pixel_polynomial import Linear, Quadratic, integers, quadratic_terms, squared, times
from tests.oracle.rounding import exact
from tests.oracle.view import Affine, View, matrix


class HalfSpace(NamedTuple):
    """e(p) + g(p)·t >= 0."""

    e: Linear
    g: Linear


class Cap(NamedTuple):
    """A flat disc at object z = z0 (kind 1) or z1 (kind 2), where e(p) + g(p)·t = 0."""

    kind: int
    e: Linear
    g: Linear


class ExactQuadric:
    """Quadric `index` of a scene, from the exact values of its arrays.

    Attributes:
        a, b, c: the quadratic in t, as polynomials in p.
        s: b² - a·c, again quadratic in p: pinhole rays share c, orthographic rays a, and b is linear.
        always: half-spaces that hold for every hit: near, far and clips.
        extent: half-spaces of z_range, for the surface alone (a cap lies in its plane).
        caps: the flat discs.
    """

    def __init__(self, view: View, quadrics: Quadrics, index: int) -> None:
        self.index = index
        self.id = int(quadrics.id[index])
        self._view = view
        self._form = object_form(quadrics, index)
        world_from_object = matrix([*quadrics.world_from_object[index].tolist(), [0.0, 0.0, 0.0, 1.0]])
        self._object_from_world = world_from_object.inv()
        object_from_camera = self._object_from_world * view.world_from_camera
        self._origin = object_from_camera * view.origin
        self._direction = object_from_camera * view.direction
        self._set_surface()
        self._set_bounds(quadrics, index)

    def _set_surface(self) -> None:
        form_direction = self._form * self._direction
        a = self._direction.transpose() * form_direction
        b = self._origin.transpose() * form_direction
        c = self._origin.transpose() * self._form * self._origin
        terms, _ = integers(quadratic_terms(a) + quadratic_terms(b) + quadratic_terms(c))
        self.a, self.b, self.c = Quadratic(*terms[:6]), Quadratic(*terms[6:12]), Quadratic(*terms[12:])
        shared, varying = (self.c, self.a) if self._view.is_pinhole else (self.a, self.c)
        self.linear_b = Linear(*self.b[3:])
        self.s = squared(self.linear_b).minus(varying, shared.one)

    def _set_bounds(self, quadrics: Quadrics, index: int) -> None:
        camera = self._view.camera
        origin_world = self._view.world_from_camera * self._view.origin
        direction_world = self._view.world_from_camera * self._view.direction
        none = [fmpq(0)] * 3
        self.always = []
        if camera.near:  # t > 0 goes without saying
            self.always.append(_half_space([*none[:2], -exact(camera.near)], [*none[:2], fmpq(1)]))
        if np.isfinite(camera.far):
            self.always.append(_half_space([*none[:2], exact(camera.far)], [*none[:2], fmpq(-1)]))
        start, stop = quadrics.clip_start[index : index + 2]
        for row in quadrics.clip[start:stop]:
            plane = fmpq_mat([[exact(value) for value in row.tolist()]])
            self.always.append(_half_space((plane * origin_world).entries(), (plane * direction_world).entries()))
        self.extent = []
        self.caps = []
        height, climb = self._origin.tolist()[2], self._direction.tolist()[2]
        for kind, side, bound in zip((1, 2), (1, -1), quadrics.z_range[index].tolist(), strict=True):
            if not np.isfinite(bound):
                continue
            above = [height[0], height[1], height[2] - exact(bound)]
            self.extent.append(_half_space([side * value for value in above], [side * value for value in climb]))
            if quadrics.capped[index]:
                self.caps.append(Cap(kind, *_half_space(above, climb)))

    @cached_property
    def discs(self) -> list[Quadratic]:
        """For each cap, f at the cap point times a positive square: f <= 0 on the disc. Again quadratic in p."""
        polynomials = []
        for cap in self.caps:
            if self._view.is_pinhole:
                e = cap.e.one
                terms = zip(self.a, times(self.linear_b, cap.g), squared(cap.g), strict=True)
                polynomials.append(Quadratic(*(e * e * a - 2 * e * bg + self.c.one * gg for a, bg, gg in terms)))
            else:
                g = cap.g.one
                terms = zip(self.c, times(self.linear_b, cap.e), squared(cap.e), strict=True)
                polynomials.append(Quadratic(*(g * g * c - 2 * g * be + self.a.one * ee for c, be, ee in terms)))
        return polynomials

    @cached_property
    def gradient(self) -> tuple[Affine, Affine]:
        """Half of ∇f along the ray, world coordinates: first + second·t, up to one positive factor."""
        object_normal = fmpq_mat([row[:4] for row in self._form.tolist()[:3]])
        world_normal = self._linear_object_from_world().transpose() * object_normal
        return _over_one_denominator(world_normal * self._origin, world_normal * self._direction)

    @cached_property
    def axis(self) -> tuple[fmpz, fmpz, fmpz]:
        """The object's +z as a world normal (inverse transpose), up to a positive factor."""
        entries, _ = integers(self._linear_object_from_world().tolist()[2])
        return entries[0], entries[1], entries[2]

    def _linear_object_from_world(self) -> fmpq_mat:
        return fmpq_mat([row[:3] for row in self._object_from_world.tolist()[:3]])


def object_form(quadrics: Quadrics, index: int) -> fmpq_mat:
    """Q of f = xᵀQx in object space, exactly: 4×4."""
    shape = SHAPES[quadrics.shape[index]]
    if shape.name == "quadric":
        return matrix(quadrics.matrix[quadrics.matrix_row[index]].tolist())
    radii = quadrics.radii[index].tolist()
    form = fmpq_mat(4, 4)
    for axis in range(3):
        form[axis, axis] = fmpq(shape.squares[axis]) / exact(radii[axis]) ** 2
    form[2, 3] = form[3, 2] = fmpq(shape.linear_z, 2)
    form[3, 3] = fmpq(shape.constant)
    return form


def _half_space(e: list[fmpq], g: list[fmpq]) -> HalfSpace:
    entries, _ = integers([*e, *g])
    return HalfSpace(Linear(*entries[:3]), Linear(*entries[3:]))


def _over_one_denominator(first: fmpq_mat, second: fmpq_mat) -> tuple[Affine, Affine]:
    entries, denominator = integers([*first.entries(), *second.entries()])
    rows = [Linear(*entries[k : k + 3]) for k in range(0, 18, 3)]
    return Affine((rows[0], rows[1], rows[2]), denominator), Affine((rows[3], rows[4], rows[5]), denominator)
