"""`STRESS`: small scenes that only `exact` promises to get right, by name; each module below enters its own.

Every scene is a few hundred pixels, so that the exact reference can answer all of them.
"""

import math
from collections.abc import Callable

from tests.scenes.catalogue import Document, SmallScene, document

STRESS: dict[str, SmallScene] = {}

# Puts the centre of pixel (8, 6) on the axis of view.
CENTRED = {"cx": 8.5, "cy": 6.5}
IDENTITY = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
# Object z points up in the image, 4 in front of the camera.
UPRIGHT = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, -4], [0, 0, 0, 1]]


def enter(name: str, reason: str, quadrics: list[Document], camera: Document, **output: object) -> None:
    """Enter one scene, with every channel."""
    assert name not in STRESS, f"{name} is there already"
    assert reason, f"{name} has no reason"
    STRESS[name] = SmallScene(name, reason, document(quadrics, camera, **output), only_exact=True)


def stress(make: Callable[[], tuple[list[Document], Document]]) -> Callable[[], tuple[list[Document], Document]]:
    """Enter the quadrics and the camera that a function makes: its name, and its docstring as the reason."""
    enter(make.__name__, make.__doc__ or "", *make())
    return make


def pinhole(**keys: object) -> Document:
    """16×12 pixels from the origin: 5⅓ × 4 units at z = -4."""
    return {"width": 16, "height": 12, "fx": 12, "fy": 12, **keys}


def orthographic(**keys: object) -> Document:
    """16×12 pixels of a quarter of a unit."""
    return {"projection": "orthographic", "width": 16, "height": 12, "fx": 4, "fy": 4, **keys}


def posed(x: float, y: float, z: float) -> Document:
    """A camera moved and not turned."""
    return {"world_from_camera": [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]}


def form(*ten: float, **keys: object) -> Document:
    """A `quadric` by its coefficients."""
    return {"shape": "quadric", "coefficients": list(ten), **keys}


def ball(x: float, y: float, z: float, radius: float, **keys: object) -> Document:
    return {"shape": "sphere", "center": [x, y, z], "radius": radius, **keys}


def up(value: float, steps: int = 1) -> float:
    """The binary64 that many numbers above (below, where negative)."""
    for _ in range(abs(steps)):
        value = math.nextafter(value, math.inf if steps > 0 else -math.inf)
    return value
