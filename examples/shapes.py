"""Write shapes.json: every shape of the scene document once, thirteen of them on a floor that is the fourteenth.

python examples/shapes.py
"""

import json
import math
from pathlib import Path
from typing import Any

Quadric = dict[str, Any]
HalfSpace = list[float]

SPACING_X = 3.1
SPACING_Y = 3.4


def box(x: float, y: float, half: float) -> list[HalfSpace]:
    """Four upright walls about (x, y): what reaches to infinity is cut off there."""
    return [[1, 0, 0, half - x], [-1, 0, 0, half + x], [0, 1, 0, half - y], [0, -1, 0, half + y]]


def floor(rx: float, ry: float) -> Quadric:
    """The plane z = 0 within an octagon drawn around an ellipse."""
    corners = [(math.cos((k + 0.5) * math.pi / 4), math.sin((k + 0.5) * math.pi / 4)) for k in range(8)]
    clip = [[round(-c / rx, 6), round(-s / ry, 6), 0, 1] for c, s in corners]
    return {"shape": "plane", "name": "floor", "clip": clip}


def turn(axis: str, degrees: float) -> list[float]:
    """Quaternion [x, y, z, w] of a turn about a coordinate axis."""
    half = math.radians(degrees) / 2
    return [round(math.sin(half), 6) if name == axis else 0 for name in "xyz"] + [round(math.cos(half), 6)]


# Each row from left to right, the front row first. All stand on the floor: their lowest point is z = 0.
ROWS: list[list[Quadric]] = [
    [
        {"shape": "sphere"},
        {"shape": "paraboloid", "radius": 0.75, "z_range": [0, 2], "lift": 0},
        {"shape": "hyperbolic_paraboloid", "radii": [1, 1], "z_range": [-1, 1], "walls": 1.0},
        {"shape": "hyperboloid_two_sheets", "radii": [0.4, 0.4, 0.4], "z_range": [-1, 1]},
    ],
    [
        {"shape": "parabolic_cylinder", "radius": 0.75, "z_range": [0, 2], "walls": 1.1, "lift": 0},
        {"shape": "quadric", "coefficients": [1.6, 0.5, -0.6, 0, 2.2, 0.4, 0, 1.35, 0, -1]},
        {"shape": "hyperboloid_one_sheet", "radii": [0.55, 0.55, 0.65], "z_range": [-1, 1]},
        {"shape": "ellipsoid", "radii": [1.15, 0.75, 1]},
        {"shape": "hyperbolic_cylinder", "radii": [0.35, 0.4], "z_range": [-1, 1], "walls": 1.1},
    ],
    [
        {"shape": "crossed_planes", "radii": [1, 1], "z_range": [-1, 1], "walls": 1.0},
        {"shape": "cylinder", "radius": 0.8, "z_range": [-1, 1], "capped": True},
        {"shape": "cone", "radius": 0.85, "z_range": [-1, 1]},
        {"shape": "parallel_planes", "radius": 0.45, "rotation": turn("x", 90), "walls": 1.0},
    ],
]


def place(quadric: Quadric, x: float, y: float) -> Quadric:
    """A shape of ROWS at its place: `walls` become clips about it, `lift` (1) the height of its centre."""
    placed = dict(quadric)
    half, lift = placed.pop("walls", None), placed.pop("lift", 1)
    placed["center"] = [round(x, 6), round(y, 6), lift]
    if half is not None:
        placed["clip"] = [[round(value, 6) for value in plane] for plane in box(x, y, half)]
    if placed["shape"] == "parallel_planes":
        placed["clip"] += [[0, 0, 1, 0], [0, 0, -1, 2]]
    return placed


def scene() -> dict[str, Any]:
    """The gallery and its camera."""
    quadrics = [floor(8.0, 5.6)]
    for j, row in enumerate(ROWS):
        for i, quadric in enumerate(row):
            quadrics.append(place(quadric, (i - (len(row) - 1) / 2) * SPACING_X, (j - 1) * SPACING_Y))
    return {
        "conicoid": 1,
        "quadrics": quadrics,
        "camera": {
            "width": 1920,
            "height": 1000,
            "fov_y": 22.5,
            "look_at": {"eye": [-3, -20, 19], "target": [0.1, -0.3, 0.35], "up": [0, 0, 1]},
        },
        "output": {"channels": ["Z", "N", "id"]},
    }


if __name__ == "__main__":
    lines = json.dumps(scene()).replace('{"shape"', '\n{"shape"').replace('], "camera"', '\n], "camera"')
    Path(__file__).with_suffix(".json").write_text(lines + "\n")
