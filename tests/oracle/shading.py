"""Depths, normal and position of a hit: correctly rounded, or to binary64."""

from functools import partial

import numpy as np
from flint import arb, ctx, fmpq, fmpz
from numpy.typing import NDArray

from conicoid.scene import Output
from tests.oracle.exact_quadric import ExactQuadric
from tests.oracle.hits import CAP_Z0, SURFACE, Hit
from tests.oracle.rounding import closest_float, rounded_float32
from tests.oracle.surd import Surd, sign_of_linear, sign_of_sum
from tests.oracle.view import Affine, View

Vector = NDArray[np.float64]
Sum = tuple[fmpz, fmpz]  # a + b√s, with s known from the hit


def planar_depth(t: Surd) -> np.float32:
    """t, rounded to nearest-even float32."""
    return rounded_float32(t.enclosure, lambda value: sign_of_linear(-value.p, value.q, t) == 0)


def ray_distance(view: View, t: Surd, i: int, j: int) -> np.float32:
    """t·|d|, rounded to nearest-even float32; t > 0."""
    x, y, z = (row.at(i, j) for row in view.camera_direction.rows)
    squared_length = fmpq(x * x + y * y + z * z, view.camera_direction.denominator**2)

    def enclose(bits: int) -> arb:
        with ctx.workprec(bits):
            return t.enclosure(bits) * arb(squared_length).sqrt()

    def equals(value: fmpq) -> bool:
        # Both sides are positive, so squares decide: |d|²(r + k√s)² = value²·m².
        target = value * value / squared_length
        rational = target.q * (t.r * t.r + t.k * t.k * t.s) - target.p * t.m * t.m
        return sign_of_sum(rational, 2 * target.q * t.r * t.k, t.s) == 0

    return rounded_float32(enclose, equals)


def position(view: View, t: Surd, i: int, j: int) -> Vector:
    """World position, each component within 2^-52 of the largest one."""
    origin, direction = view.world_origin, view.world_direction
    # o/p + d·t/q over the common denominator p·q·m.
    components = _along_ray(origin, direction, t, i, j, (direction.denominator, origin.denominator))
    return _as_floats(components, t.s, origin.denominator * direction.denominator * t.m)


def normal(view: View, output: Output, quadric: ExactQuadric, hit: Hit, i: int, j: int) -> Vector:
    """Unit normal in the asked space and on the asked side, each component within 2^-52; no component is -0."""
    if hit.kind == SURFACE:
        first, second = quadric.gradient
        world = _along_ray(first, second, hit.t, i, j, (fmpz(1), fmpz(1)))
    else:
        outward = -1 if hit.kind == CAP_Z0 else 1
        world = [(outward * component, fmpz(0)) for component in quadric.axis]
    if all(sign_of_sum(a, b, hit.t.s) == 0 for a, b in world):
        towards = view.world_direction if output.normal_space == "world" else view.camera_direction
        return _unit([(-row.at(i, j), fmpz(0)) for row in towards.rows], fmpz(0))
    components = world if output.normal_space == "world" else _covector_in_camera(view, world)
    if output.normal_side == "facing" and hit.slope > 0:
        components = [(-a, -b) for a, b in components]
    return _unit(components, hit.t.s)


def _along_ray(first: Affine, second: Affine, t: Surd, i: int, j: int, weights: tuple[fmpz, fmpz]) -> list[Sum]:
    """first·weights[0] + second·weights[1]·t at one pixel, times t.m: three sums a + b√s."""
    components = []
    for still, moving in zip(first.rows, second.rows, strict=True):
        rate = moving.at(i, j) * weights[1]
        components.append((still.at(i, j) * weights[0] * t.m + rate * t.r, rate * t.k))
    return components


def _covector_in_camera(view: View, world: list[Sum]) -> list[Sum]:
    """∇ with respect to camera coordinates: the transpose of world_from_camera's linear part times the world's ∇."""
    linear, _ = view.world_from_camera.numer_denom()
    rows = linear.tolist()
    return [
        (
            sum((rows[k][axis] * world[k][0] for k in range(3)), fmpz(0)),
            sum((rows[k][axis] * world[k][1] for k in range(3)), fmpz(0)),
        )
        for axis in range(3)
    ]


def _balls(components: list[Sum], s: fmpz, bits: int) -> list[arb]:
    with ctx.workprec(bits):
        root = arb(s).sqrt()
        return [arb(a) if sign_of_sum(fmpz(0), b, s) == 0 else a + b * root for a, b in components]


def _length(components: list[Sum], s: fmpz, bits: int) -> arb:
    with ctx.workprec(bits):
        return sum((ball * ball for ball in _balls(components, s, bits)), arb(0)).sqrt()


def _unit(components: list[Sum], s: fmpz) -> Vector:
    def ratio(axis: int, bits: int) -> arb:
        with ctx.workprec(bits):
            return _balls(components, s, bits)[axis] / _length(components, s, bits)

    values = [closest_float(partial(ratio, axis), lambda _: arb(1)) for axis in range(3)]
    # Adding +0 turns -0 into +0 and changes nothing else.
    return np.array(values) + 0.0


def _as_floats(components: list[Sum], s: fmpz, denominator: fmpz) -> Vector:
    def part(axis: int, bits: int) -> arb:
        with ctx.workprec(bits):
            return _balls(components, s, bits)[axis] / denominator

    def size(bits: int) -> arb:
        with ctx.workprec(bits):
            return _length(components, s, bits) / denominator

    if all(sign_of_sum(a, b, s) == 0 for a, b in components):
        return np.zeros(3)
    return np.array([closest_float(partial(part, axis), size) for axis in range(3)])
