"""Quadrics of every shape, extent and placement at random: the same for the same seed."""

import random
from collections.abc import Sequence

from tests.scenes.catalogue import PROJECTIONS, Document
from tests.scenes.stress import enter

RADIUS = ("sphere", "parabolic_cylinder", "parallel_planes")
TWO_RADII = ("cylinder", "cone", "paraboloid", "hyperbolic_paraboloid", "hyperbolic_cylinder", "crossed_planes")
THREE_RADII = ("ellipsoid", "hyperboloid_one_sheet", "hyperboloid_two_sheets")
# A plane may contain its own range, cap or clip: whole images of ties.
FLAT = ("parallel_planes", "crossed_planes", "plane", "quadric")
SHAPES = (*RADIUS, *TWO_RADII, *THREE_RADII, "plane", "quadric")
CURVED = tuple(shape for shape in SHAPES if shape not in FLAT)


class Mix:
    """Draws scenes; about a third of all numbers have few bits, so that ties, tangents and rays within surfaces occur.

    Args:
        seed: of everything.
        spread: size of the volume that the quadrics fill, against their own size of about 1.
        shapes: to draw from.
    """

    def __init__(self, seed: int, spread: float = 1.0, shapes: Sequence[str] = SHAPES) -> None:
        self._draw = random.Random(seed)
        self._spread = spread
        self._shapes = shapes

    def scene(
        self, count: int, projection: str, width: int = 16, height: int = 12
    ) -> tuple[list[Document], Document, Document]:
        """`count` quadrics (a tenth of them twice), a camera that sees most of them, and the sides of normals."""
        quadrics: list[Document] = []
        while len(quadrics) < count:
            quadric = self._shape() | self._placement()
            if quadric["shape"] not in {"sphere", "ellipsoid"} or self._chance(0.4):
                low = self._number(-0.75, 0.5)
                quadric |= {"z_range": [low, low + self._number(0, 1)], "capped": self._chance(0.6)}
            if self._chance(0.3):
                quadric["clip"] = [self._half_space() for _ in range(self._draw.randrange(1, 4))]
            quadrics.append(quadric)
            if self._chance(0.1):
                quadrics.append({**quadric, "id": self._id()})
        output = {
            "normal_side": self._draw.choice(("facing", "outward")),
            "normal_space": self._draw.choice(("world", "camera")),
        }
        return quadrics, self._camera(projection, width, height), output

    def _chance(self, probability: float) -> bool:
        return self._draw.random() < probability

    def _number(self, low: float, high: float) -> float:
        value = self._draw.uniform(low, high)
        return round(value * 4) / 4 if self._chance(0.33) else value

    def _size(self) -> float:
        return self._number(0.25, 1.0)

    def _id(self) -> int:
        return self._draw.randrange(1, 2**32)

    def _half_space(self) -> list[float]:
        normal = [self._number(-1, 1) for _ in range(3)]
        return [*(normal if any(normal) else [1.0, 0.0, 0.0]), self._number(-2, 6)]

    def _shape(self) -> Document:
        shape = self._draw.choice(self._shapes)
        quadric: Document = {"shape": shape, "id": self._id()}
        if shape in RADIUS:
            quadric["radius"] = self._size()
        elif shape in TWO_RADII:
            quadric["radii"] = [self._size(), self._size()]
        elif shape in THREE_RADII:
            quadric["radii"] = [self._size(), self._size(), self._size()]
        elif shape == "quadric":
            quadric["coefficients"] = [*(self._number(-1, 1) for _ in range(9)), self._number(-1, 1) or 1.0]
        return quadric

    def _placement(self) -> Document:
        half = 2.5 * self._spread
        centre = [self._number(-half, half), self._number(-half, half), self._number(-5.5 - half, -5.5 + half)]
        if self._chance(0.2):
            rows = [[(i == j) + self._number(-0.4, 0.4) for j in range(3)] + [centre[i]] for i in range(3)]
            return {"transform": [*rows, [0, 0, 0, 1]]}
        if self._chance(0.25):
            return {"center": centre}
        turn = [self._number(-1, 1), self._number(-1, 1), self._number(-1, 1), self._number(0.25, 1)]
        return {"center": centre, "rotation": turn}

    def _camera(self, projection: str, width: int, height: int) -> Document:
        focal = (0.75 if projection == "pinhole" else 0.25) * width
        camera: Document = {"projection": projection, "width": width, "height": height, "fx": focal, "fy": focal}
        if self._chance(0.5):
            camera |= {"near": self._number(0, 3.5), "far": self._number(6, 9)}
        if self._chance(0.5):
            camera["look_at"] = {
                "eye": [self._number(-1, 1), self._number(-1, 1), self._number(0, 1)],
                "target": [0, self._number(-0.5, 0.5), -5],
                "up": [self._number(-0.3, 0.3), 1, 0],
            }
        return camera


for number in range(10):
    kind = PROJECTIONS[number % 2]
    drawn, seen_by, sides = Mix(number).scene(12, kind)
    enter(f"mix_{number}", f"twelve quadrics of all shapes, {kind}, seed {number}", drawn, seen_by, **sides)
