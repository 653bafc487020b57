"""Generated scenes of ranged, capped and clipped quadrics, each in the place of an ellipsoid of workloads.py."""

from dataclasses import replace

import numpy as np

from conicoid.scene import Floats, Quadrics, Scene
from conicoid.shapes import SHAPES
from conicoid_bench.workloads import ellipsoids, quadrics_of, spheres

_CODE = {shape.name: shape.code for shape in SHAPES}
_RULED = ("cone", "hyperboloid_one_sheet", "hyperboloid_two_sheets", "paraboloid")
_ARRAYS = ("shape", "radii", "matrix_row", "world_from_object", "z_range", "capped")
_SLENDER = 8  # a stick's length over its diameter


def sticks(count: int, coverage: float) -> Scene:
    """Capped cylinders turned at random, eight times as long as thick, that together cover `coverage` of the image."""
    scene = ellipsoids(count, coverage)
    size, centre, turn = _placed(scene)
    # Turned at random, one shows pi / 4 of its length on average.
    radius = size / np.sqrt(_SLENDER)
    return replace(scene, quadrics=_cylinders(radius, _SLENDER * radius, centre, turn))


def balls_and_sticks(count: int, coverage: float) -> Scene:
    """`count` times two balls and the stick between them, as the bonds of a molecule are drawn."""
    scene = spheres(2 * count, coverage)
    size, centre, _ = _placed(scene)
    turn = _placed(ellipsoids(count, coverage))[2]
    along = 2 * size[:count, None] * turn[:, :, 2]
    place = scene.quadrics.world_from_object.copy()
    place[count:, :, 3] = centre[:count] + 2 * along
    radii = np.tile(size[:count, None], (2, 3))
    balls = replace(scene.quadrics, radii=radii, world_from_object=place)
    between = _cylinders(size[:count] / 3, 2 * size[:count], centre[:count] + along, turn)
    return replace(scene, quadrics=_joined(balls, between))


def ruled(count: int, coverage: float) -> Scene:
    """Ranged cones, hyperboloids and paraboloids in turn, every other one capped."""
    scene = ellipsoids(count, coverage)
    size, centre, turn = _placed(scene)
    order = np.arange(count)
    shape = np.array([_CODE[name] for name in _RULED], dtype=np.uint8)[order % len(_RULED)]
    radii = np.repeat(size[:, None] / 2, 3, axis=1)
    radii[shape == _CODE["cone"]] = [0.5, 0.5, 1.0]
    bowls = shape == _CODE["paraboloid"]
    radii[bowls] = np.column_stack([np.sqrt(size) / 2, np.sqrt(size) / 2, np.ones(count)])[bowls]
    z_range = size[:, None] * np.where(bowls[:, None], [0.0, 1.0], [-1.0, 1.0])
    quadrics = quadrics_of(radii, centre, turn)
    return replace(scene, quadrics=replace(quadrics, shape=shape, z_range=z_range, capped=order % 8 < len(_RULED)))


def half_spheres(count: int, coverage: float) -> Scene:
    """The open halves that a plane through the middle leaves of spheres."""
    scene = spheres(count, coverage)
    normal = _placed(ellipsoids(count, coverage))[2][:, 2]
    offset = -(normal * scene.quadrics.world_from_object[:, :, 3]).sum(axis=1)
    clip = np.concatenate([normal, offset[:, None]], axis=1)
    start = np.arange(count + 1, dtype=np.int32)
    return replace(scene, quadrics=replace(scene.quadrics, clip=clip, clip_start=start))


def _placed(scene: Scene) -> tuple[Floats, Floats, Floats]:
    """Mean radii (n,), centres (n, 3) and rotations (n, 3, 3)."""
    place = scene.quadrics.world_from_object
    return np.cbrt(scene.quadrics.radii.prod(axis=1)), place[:, :, 3], place[:, :, :3]


def _cylinders(radius: Floats, half_length: Floats, centre: Floats, turn: Floats) -> Quadrics:
    radii = np.column_stack([radius, radius, np.ones_like(radius)])
    quadrics = quadrics_of(radii, centre, turn)
    return replace(
        quadrics,
        shape=np.full(len(radius), _CODE["cylinder"], dtype=np.uint8),
        z_range=half_length[:, None] * [-1.0, 1.0],
        capped=np.ones(len(radius), dtype=np.bool_),
    )


def _joined(first: Quadrics, second: Quadrics) -> Quadrics:
    """Both, neither of which has clips, matrices or names."""
    shape, radii, matrix_row, place, z_range, capped = (
        np.concatenate([getattr(first, name), getattr(second, name)]) for name in _ARRAYS
    )
    count = len(shape)
    ids = np.arange(1, count + 1, dtype=np.uint32)
    start = np.zeros(count + 1, dtype=np.int32)
    return Quadrics(shape, radii, matrix_row, first.matrix, place, ids, z_range, capped, first.clip, start, {})
