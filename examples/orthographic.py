"""Write orthographic.json: the head of a sunflower, seen from above without perspective.

python examples/orthographic.py
"""

import json
import math
from pathlib import Path
from typing import Any

SEEDS = 610
GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))
DOME = 0.055


def seed(k: int) -> dict[str, Any]:
    """Seed k of Vogel's spiral (Mathematical Biosciences 44, 1979): radius sqrt(k), turned by the golden angle.

    Each stands upright on a dome z = -DOME r^2, so it leans outwards by atan(2 DOME r).
    """
    r, angle = 0.32 * math.sqrt(k + 0.5), k * GOLDEN_ANGLE
    lean = math.atan(2 * DOME * r)
    size = 0.26 + 0.012 * r
    return {
        "shape": "ellipsoid",
        "radii": [round(x, 6) for x in (size * 0.85, size, size * 2)],
        "center": [round(x, 6) for x in (r * math.cos(angle), r * math.sin(angle), -DOME * r * r)],
        "rotation": [round(x, 9) for x in lean_outwards(angle, lean)],
    }


def lean_outwards(angle: float, lean: float) -> tuple[float, float, float, float]:
    """Quaternion [x, y, z, w]: first tilt z towards x by `lean`, then turn about z by `angle`."""
    half_lean, half_angle = lean / 2, angle / 2
    return (
        -math.sin(half_angle) * math.sin(half_lean),
        math.cos(half_angle) * math.sin(half_lean),
        math.sin(half_angle) * math.cos(half_lean),
        math.cos(half_angle) * math.cos(half_lean),
    )


def scene() -> dict[str, Any]:
    """The seeds on a paraboloid that closes the gaps between them."""
    rim = 0.32 * math.sqrt(SEEDS)
    head = {
        "shape": "paraboloid",
        "radius": round(1 / math.sqrt(DOME), 6),
        "rotation": [1, 0, 0, 0],
        "z_range": [0, round(DOME * rim * rim, 6)],
    }
    return {
        "conicoid": 1,
        "quadrics": [head, *(seed(k) for k in range(SEEDS))],
        "camera": {
            "projection": "orthographic",
            "width": 1200,
            "height": 1200,
            "view_height": 17.5,
            "look_at": {"eye": [0, 0, 20], "target": [0, 0, 0], "up": [0, 1, 0]},
        },
        "output": {"channels": ["Z", "N"]},
    }


if __name__ == "__main__":
    lines = json.dumps(scene()).replace('{"shape"', '\n{"shape"').replace('], "camera"', '\n], "camera"')
    Path(__file__).with_suffix(".json").write_text(lines + "\n")
