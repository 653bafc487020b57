"""The oracle against the contract read literally: one ray at a time, in object space, to 150 digits.

Nothing here is shared with the oracle but the scene's arrays: no polynomials in the pixel, no integers, no culling;
plain fractions, a root taken to 150 digits, and numbers equal where they agree to 60. In these scenes different
depths differ by far more, and what should be zero is zero to 150 digits.
"""

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from conicoid.scene import Scene
from conicoid.shapes import SHAPES
from tests import oracle
from tests.scenes import CATALOGUE, as_scene

ROOT_DIGITS = 10**150
EQUAL = Fraction(1, 10**60)
STRIDE = 11  # coprime to the widths in the catalogue: rows are sampled at different columns

Vector = list[Fraction]


class DirectHit(NamedTuple):
    t: Fraction
    quadric: int
    kind: int
    normal: Vector  # outward, world, any length


def fractions(values: Iterable[float]) -> Vector:
    return [Fraction(float(value)) for value in values]


def dot(a: Vector, b: Vector) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def root(value: Fraction) -> Fraction:
    scaled = value * ROOT_DIGITS**2
    return Fraction(math.isqrt(scaled.numerator // scaled.denominator), ROOT_DIGITS)


def inverse(m: list[Vector]) -> list[Vector]:
    """Of a 3×3 matrix, by cofactors."""
    cofactor = [
        [
            m[(r + 1) % 3][(c + 1) % 3] * m[(r + 2) % 3][(c + 2) % 3]
            - m[(r + 1) % 3][(c + 2) % 3] * m[(r + 2) % 3][(c + 1) % 3]
            for c in range(3)
        ]
        for r in range(3)
    ]
    determinant = dot(m[0], cofactor[0])
    return [[cofactor[c][r] / determinant for c in range(3)] for r in range(3)]


def ray(scene: Scene, i: int, j: int) -> tuple[Vector, Vector, Vector]:
    """World origin and direction, and the camera's own direction."""
    camera = scene.camera
    fx, fy, cx, cy = fractions([camera.fx, camera.fy, camera.cx, camera.cy])
    x, y = (i + Fraction(1, 2) - cx) / fx, -(j + Fraction(1, 2) - cy) / fy
    if camera.projection == "pinhole":
        start, direction = [Fraction(0)] * 3, [x, y, Fraction(-1)]
    else:
        start, direction = [x, y, Fraction(0)], [Fraction(0), Fraction(0), Fraction(-1)]
    rows = [fractions(row) for row in camera.world_from_camera[:3]]
    return [dot(row[:3], start) + row[3] for row in rows], [dot(row[:3], direction) for row in rows], direction


def value_and_gradient(scene: Scene, index: int, p: Vector) -> tuple[Fraction, Vector]:
    """f and half of ∇f at a point of object space, by the contract's table."""
    quadrics = scene.quadrics
    shape = SHAPES[quadrics.shape[index]]
    if shape.name == "quadric":
        rows = [fractions(row) for row in quadrics.matrix[quadrics.matrix_row[index]]]
        images = [dot(row, [*p, Fraction(1)]) for row in rows]
        return dot(images, [*p, Fraction(1)]), images[:3]
    weights = [sign / r**2 for sign, r in zip(shape.squares, fractions(quadrics.radii[index]), strict=True)]
    value = dot(weights, [x * x for x in p]) + shape.linear_z * p[2] + shape.constant
    gradient = [weight * x for weight, x in zip(weights, p, strict=True)]
    gradient[2] += Fraction(shape.linear_z, 2)
    return value, gradient


def hits(scene: Scene, index: int, origin: Vector, direction: Vector) -> Iterator[DirectHit]:
    """Kept hits of one quadric."""
    quadrics, camera = scene.quadrics, scene.camera
    rows = [fractions(row) for row in quadrics.world_from_object[index]]
    back = inverse([row[:3] for row in rows])
    shifted = [x - row[3] for x, row in zip(origin, rows, strict=True)]
    o, d = [dot(row, shifted) for row in back], [dot(row, direction) for row in back]

    def at(t: Fraction) -> Vector:
        return [x + t * y for x, y in zip(o, d, strict=True)]

    def f(t: Fraction) -> Fraction:
        return value_and_gradient(scene, index, at(t))[0]

    def kept(t: Fraction) -> bool:
        world = [x + t * y for x, y in zip(origin, direction, strict=True)]
        clips = [fractions(row) for row in quadrics.clip[slice(*quadrics.clip_start[index : index + 2])]]
        inside = all(dot(clip[:3], world) + clip[3] >= -EQUAL for clip in clips)
        far = camera.far == math.inf or t <= Fraction(camera.far) + EQUAL
        return t > EQUAL and t >= Fraction(camera.near) - EQUAL and far and inside

    def world_normal(normal: Vector) -> Vector:
        return [dot([row[axis] for row in back], normal) for axis in range(3)]

    low, high = quadrics.z_range[index].tolist()
    # The parabola through three values of f: f(0) = c, f(±1) = a ± 2b + c.
    c, plus, minus = f(Fraction(0)), f(Fraction(1)), f(Fraction(-1))
    a, b = (plus + minus) / 2 - c, (plus - minus) / 4
    for t in real_roots(a, b, c):
        z = at(t)[2]
        if kept(t) and (low == -math.inf or Fraction(low) - EQUAL <= z <= Fraction(high) + EQUAL):
            yield DirectHit(t, index, 0, world_normal(value_and_gradient(scene, index, at(t))[1]))
    for kind, bound in ((1, low), (2, high)):
        if quadrics.capped[index] and d[2]:
            t = (Fraction(bound) - o[2]) / d[2]
            if kept(t) and f(t) <= EQUAL:
                yield DirectHit(t, index, kind, world_normal([Fraction(0), Fraction(0), Fraction(2 * kind - 3)]))


def real_roots(a: Fraction, b: Fraction, c: Fraction) -> list[Fraction]:
    if not a:
        return [-c / (2 * b)] if b else []
    s = b * b - a * c
    return [] if s < 0 else [-b / a] if not s else [(-b - root(s)) / a, (-b + root(s)) / a]


def unit(v: Vector) -> NDArray[np.float64]:
    length = root(dot(v, v) * 10**40) / 10**20
    return np.array([float(x / length) for x in v])


# The scenes whose numbers are of moderate size: 1e15 and 1e200 would need other equalities.
MODERATE = [name for name in CATALOGUE if not name.startswith(("huge", "tiny", "depth_beyond"))]


@pytest.mark.parametrize("name", MODERATE)
def test_the_oracle_agrees_with_the_contract_read_literally(name: str) -> None:
    scene = as_scene(CATALOGUE[name].document)
    x0, y0, x1, y1 = scene.camera.crop
    window = [(i, j) for j in range(y0, y1) for i in range(x0, x1)]
    pixels = window[:: STRIDE * (1 + len(scene.quadrics) // 4)]
    got = oracle.pixels(scene, pixels)
    for k, (i, j) in enumerate(pixels):
        origin, direction, camera_direction = ray(scene, i, j)
        found = [hit for index in range(len(scene.quadrics)) for hit in hits(scene, index, origin, direction)]
        assert got.hit[k] == bool(found), (i, j)
        if not found:
            assert (got.id[k], got.quadric[k], got.kind[k]) == (0, -1, -1)
            continue
        nearest = min(hit.t for hit in found)
        first = min((hit for hit in found if hit.t - nearest < EQUAL), key=lambda hit: (hit.quadric, hit.kind))
        last = max(hit.t for hit in found if hit.quadric == first.quadric)
        assert (got.quadric[k], got.kind[k]) == (first.quadric, first.kind), (i, j)
        assert got.id[k] == scene.quadrics.id[first.quadric]
        # Half a unit in float32's last place; binary64's rounding of these quotients is far below the slack.
        length = float(root(dot(camera_direction, camera_direction)))
        for value, exact in ((got.depth[k], first.t), (got.back[k], last), (got.distance[k], float(first.t) * length)):
            assert abs(float(value) - float(exact)) <= 0.5000001 * float(np.spacing(np.float32(exact))), (i, j)
        position = np.array([float(x + first.t * y) for x, y in zip(origin, direction, strict=True)])
        np.testing.assert_allclose(got.position[k], position, rtol=0, atol=4e-16 * np.abs(position).max())
        np.testing.assert_allclose(
            got.normal[k], expected_normal(scene, first, direction, camera_direction), atol=1e-15
        )


def expected_normal(scene: Scene, hit: DirectHit, direction: Vector, camera_direction: Vector) -> NDArray[np.float64]:
    in_camera = scene.output.normal_space == "camera"
    if all(abs(x) < EQUAL for x in hit.normal):
        return -unit(camera_direction if in_camera else direction)
    side = -1 if scene.output.normal_side == "facing" and dot(hit.normal, direction) > EQUAL else 1
    pose = [fractions(row[:3]) for row in scene.camera.world_from_camera[:3]]
    normal = [dot([row[axis] for row in pose], hit.normal) for axis in range(3)] if in_camera else hit.normal
    return unit([side * x for x in normal])
