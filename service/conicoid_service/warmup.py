"""Scenes that make a fresh process compile every kernel it has, so that no request waits for a compiler.

OpenCL drivers compile a kernel's last stage when it is first launched, not when its program is built.
"""

from collections.abc import Iterator

import orjson

from conicoid.document import parse
from conicoid.scene import Scene

_QUADRICS = [
    {"shape": "sphere", "center": [0, 0, -3]},
    {"shape": "cylinder", "center": [1, 0, -4], "z_range": [-1, 1], "capped": True, "clip": [[0, 1, 0, 0.5]]},
]
_CAMERA = {"width": 32, "height": 32, "fov_y": 60}


def scenes() -> Iterator[Scene]:
    """A simple and a general quadric, a cap and a clip, in each precision."""
    for precision in ("float64", "float32"):
        document = {"conicoid": 1, "quadrics": _QUADRICS, "camera": _CAMERA, "output": {"precision": precision}}
        yield parse(orjson.dumps(document)).resolve()
