"""Which surface is in front: overlaps, coincidences and ties."""

import random

from tests.scenes.catalogue import Document, document, only_exact, orthographic, pinhole, scene

BALL = {"shape": "sphere", "center": [0, 0, -4], "radius": 1.5}
CAN = {"shape": "cylinder", "center": [0, 0, -4], "z_range": [-1, 1], "capped": True}


@scene
def overlapping_balls() -> Document:
    """Silhouettes inside silhouettes, and surfaces that pass through each other."""
    places = [(-1, 0, -4, 1), (0, 0.5, -4.5, 1.25), (0.5, -0.5, -3.5, 0.5), (1, 0, -5, 1.75), (0, 0, -3.9, 0.9)]
    return document([{"shape": "sphere", "center": [x, y, z], "radius": r} for x, y, z, r in places], pinhole())


@scene
def the_nearest_is_last() -> Document:
    """Document order says nothing about depth; ids are not positions."""
    quadrics = [{**BALL, "center": [0, 0, -2 * k], "radius": 0.3 * k, "id": 4_294_967_295 - k} for k in (5, 4, 3, 2)]
    return document(quadrics, pinhole())


@scene
def identical_quadrics() -> Document:
    """A tie at every pixel goes to the earlier one, whatever its id."""
    return document([{**BALL, "id": 7}, {**BALL, "id": 3}], pinhole())


@only_exact
def one_surface_written_three_ways() -> Document:
    """Sphere, ellipsoid and a matrix times 4 are one surface: the first of them is hit."""
    ellipsoid = {**BALL, "shape": "ellipsoid", "radii": [1.5, 1.5, 1.5]}
    del ellipsoid["radius"]
    matrix = [[4, 0, 0, 0], [0, 4, 0, 0], [0, 0, 4, 0], [0, 0, 0, -9]]
    quadric = {"shape": "quadric", "matrix": matrix, "center": [0, 0, -4]}
    return document([quadric, ellipsoid, BALL], orthographic())


@scene
def duplicate_ids() -> Document:
    """Two quadrics may share an id."""
    return document([{**BALL, "id": 5}, {**CAN, "center": [2, 1, -4], "id": 5}], pinhole())


@scene
def cap_on_a_plane() -> Document:
    """A can's cap lies in a plane that comes later in the document."""
    return document([CAN, {"shape": "plane", "center": [0, 0, -3]}], pinhole())


@scene
def plane_on_a_cap() -> Document:
    """The same with the plane first."""
    return document([{"shape": "plane", "center": [0, 0, -3]}, CAN], orthographic())


@scene
def cans_end_to_end() -> Document:
    """Two cans share a cap and a wall line; a third inside them shares the far cap."""
    turned = {"rotation": [0, 1, 0, 1], "shape": "cylinder", "capped": True}
    quadrics = [
        {**turned, "center": [0, 0, -4], "z_range": [-1.5, 0]},
        {**turned, "center": [0, 0, -4], "z_range": [0, 1.5]},
        {**turned, "center": [0, 0, -4], "radius": 0.5, "z_range": [-1.5, 1.5]},
    ]
    return document(quadrics, pinhole())


@scene
def touching_balls() -> Document:
    """Two balls that share one point, seen from the side and through each other."""
    return document([BALL, {**BALL, "center": [0, 0, -7]}, {**BALL, "center": [3, 0, -4]}], orthographic())


@only_exact
def tangent_rays() -> Document:
    """Parallel rays that touch a ball in one point hit it: closed by convention."""
    camera = orthographic(fx=4, fy=4, cx=12.5, cy=8.5)
    del camera["view_height"]
    return document([{"shape": "sphere", "center": [0, 0, -4], "radius": 1.25}], camera)


@scene
def tangent_cylinder() -> Document:
    """Two image columns touch a cylinder along their whole length."""
    camera = orthographic(fx=4, fy=4, cx=12.5, cy=8.5)
    del camera["view_height"]
    return document([{"shape": "cylinder", "center": [0, 0, -4], "rotation": [1, 0, 0, 1]}], camera)


@scene
def nested_shells() -> Document:
    """Concentric balls with windows: the second root of the outer one is behind the inner ones."""
    shells = [{**BALL, "radius": 0.5 * k, "clip": [[0.1 * k, 0, -1, -4.5 + 0.5 * k]]} for k in (3, 2, 1)]
    return document(shells, pinhole())


@scene
def back_of_a_cap() -> Document:
    """ZBack is a cap for some rays, a wall for others, and the first hit for a few."""
    quadric = {"shape": "cone", "center": [0, 0, -4], "rotation": [0.4, 0.3, 0, 1], "z_range": [-1, 0.75],
               "capped": True, "clip": [[-1, 0, 0, 0.5]]}  # fmt: skip
    return document([quadric], pinhole())


@scene
def crowd() -> Document:
    """Thirty quadrics of all sizes in a few tiles."""
    draw = random.Random(20260101)
    shapes = ["sphere", "cylinder", "cone", "paraboloid"]
    quadrics: list[Document] = []
    for k in range(30):
        quadric: Document = {
            "shape": shapes[k % 4],
            "radius": round(draw.uniform(0.05, 0.4), 3),
            "center": [
                round(draw.uniform(-2.5, 2.5), 3),
                round(draw.uniform(-1.7, 1.7), 3),
                round(draw.uniform(-6, -3), 3),
            ],
            "rotation": [round(draw.uniform(-1, 1), 3) for _ in range(3)] + [0.5],
        }
        if quadric["shape"] != "sphere":
            quadric |= {"z_range": [-0.25, 0.5], "capped": k % 3 == 0}
        quadrics.append(quadric)
    return document(quadrics, pinhole(width=32, height=24, fx=30, fy=30))
