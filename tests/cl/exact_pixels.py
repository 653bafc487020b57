"""One pixel of a document, solved exactly on the host."""

from collections.abc import Iterable
from typing import Any, get_args

from conicoid.exact import ExactPixel, ExactScene
from conicoid.scene import Channel
from tests.scenes import Document, as_scene
from tests.scenes.catalogue import document

# Rays through the camera's axis at column 0 of row 0, one unit of slope (or of space) apart.
PINHOLE: Document = {"width": 64, "height": 16, "fx": 1, "fy": 1, "cx": 0.5, "cy": 0.5}
ORTHOGRAPHIC: Document = {**PINHOLE, "projection": "orthographic"}


def exact_scene(quadrics: list[Document], camera: Document, **output: object) -> ExactScene:
    return ExactScene(as_scene(document(quadrics, camera, **output)))


def solve(
    quadrics: list[Document],
    camera: Document,
    i: int = 0,
    j: int = 0,
    order: Iterable[int] | None = None,
    **output: Any,
) -> ExactPixel | None:
    """The pixel with every quadric for a candidate, in the given order."""
    candidates = range(len(quadrics)) if order is None else order
    return exact_scene(quadrics, camera, **output).pixel(i, j, candidates)


def hit(quadrics: list[Document], camera: Document, i: int = 0, j: int = 0, **output: Any) -> ExactPixel:
    pixel = solve(quadrics, camera, i, j, **output)
    assert pixel is not None
    return pixel


def values(scene: ExactScene, i: int, j: int, candidates: Iterable[int]) -> dict[str, float]:
    return scene.values(i, j, candidates, get_args(Channel))
