"""Write far.json: a knotted string of pearls ten thousand kilometres from the origin, the smallest 14 cm across.

At 10^7 m a single-precision number counts in whole metres. Camera and pearls are both there, and every pearl is round.

Run it as `python examples/far.py`.
"""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ORIGIN = (1.0e7, -1.0e7, 1.0e7)

Point = tuple[float, float, float]


def knot(t: float) -> Point:
    """The trefoil, a (2, 3) torus knot, for t from 0 to 1."""
    a = 2 * math.pi * t
    r = 2 + 0.9 * math.cos(3 * a)
    return r * math.cos(2 * a), r * math.sin(2 * a), 0.9 * math.sin(3 * a)


def moved(point: Point) -> list[float]:
    """A point of the picture in the world, to the micrometre."""
    return [round(o + x, 6) for o, x in zip(ORIGIN, point, strict=True)]


def radius(t: float) -> float:
    """Pearls swell and shrink nine times along the string."""
    return 0.07 + 0.12 * math.sin(math.pi * 9 * t) ** 2


def pearls() -> Iterator[dict[str, Any]]:
    """One pearl after another, each about touching the one before."""
    t = 0.0
    while t < 1:
        yield {"shape": "sphere", "center": moved(knot(t)), "radius": round(radius(t), 6)}
        speed = math.dist(knot(t), knot(t + 1e-4)) / 1e-4
        t += 2 * radius(t + radius(t) / speed) / speed


def scene() -> dict[str, Any]:
    """The pearls, and a camera that is as far away as they are."""
    return {
        "conicoid": 1,
        "quadrics": list(pearls()),
        "camera": {
            "width": 1280,
            "height": 1200,
            "fov_y": 35,
            "look_at": {"eye": moved((0.6, -2.0, 10.0)), "target": moved((0.0, 0.0, 0.0)), "up": [0, 1, 0]},
        },
        "output": {"channels": ["Z", "N"]},
    }


if __name__ == "__main__":
    lines = json.dumps(scene()).replace('{"shape"', '\n{"shape"').replace('], "camera"', '\n], "camera"')
    Path(__file__).with_suffix(".json").write_text(lines + "\n")
