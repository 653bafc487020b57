"""Write turntable.json: a double helix of beads and rungs, seen by 24 cameras around it, a batch for `conicoid submit`.

python examples/turntable.py
"""

import json
import math
from pathlib import Path
from typing import Any

FRAMES = 24
STEPS = 42
# B-DNA, in ångströms: 3.4 a step, 34.3 degrees a step, strands 10 from the axis, the minor groove narrower.
RISE, TWIST, RADIUS, GROOVE = 3.4, math.radians(34.3), 10.0, math.radians(143)


def strand_point(step: int, strand: int) -> tuple[float, float, float]:
    """Where a bead of strand 0 or 1 is; y is up."""
    angle = step * TWIST + strand * GROOVE
    return RADIUS * math.cos(angle), (step - (STEPS - 1) / 2) * RISE, RADIUS * math.sin(angle)


def rung(p: tuple[float, ...], q: tuple[float, ...]) -> dict[str, Any]:
    """A capped cylinder from p to q: its axis, z, is turned onto q - p about z x (q - p)."""
    d = [b - a for a, b in zip(p, q, strict=True)]
    length = math.hypot(*d)
    x, y, z = (value / length for value in d)
    half = [-y, x, 0.0, 1 + z]
    size = math.hypot(*half)
    return {
        "shape": "cylinder",
        "radius": 0.9,
        "center": [round(value, 6) for value in p],
        "rotation": [round(value / size, 9) for value in half],
        "z_range": [0, round(length, 6)],
        "capped": True,
    }


def camera(frame: int) -> dict[str, Any]:
    """A camera on a circle about the axis, a little above the middle."""
    angle = 2 * math.pi * frame / FRAMES
    eye = [round(150 * math.sin(angle), 6), 40, round(150 * math.cos(angle), 6)]
    view = {"eye": eye, "target": [0, 0, 0], "up": [0, 1, 0]}
    return {"width": 200, "height": 640, "fov_y": 56, "look_at": view}


def main() -> None:
    """Write the document beside this file."""
    quadrics: list[dict[str, Any]] = []
    for step in range(STEPS):
        ends = [strand_point(step, strand) for strand in (0, 1)]
        quadrics += [{"shape": "sphere", "center": [round(v, 6) for v in end], "radius": 2.6} for end in ends]
        quadrics.append(rung(*ends))
    document = {"conicoid": 1, "quadrics": quadrics, "cameras": [camera(k) for k in range(FRAMES)]}
    lines = json.dumps(document).replace('{"shape"', '\n{"shape"').replace('{"width"', '\n{"width"')
    Path(__file__).with_suffix(".json").write_text(lines + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
