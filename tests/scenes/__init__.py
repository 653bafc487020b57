"""Small scenes for tests: `CATALOGUE` by name, and `as_scene` to parse a document."""

from tests.scenes import degenerate, order, outputs, placement, shapes, viewpoints
from tests.scenes.catalogue import CATALOGUE, Document, SmallScene, as_scene

__all__ = [
    "CATALOGUE",
    "Document",
    "SmallScene",
    "as_scene",
    "degenerate",
    "order",
    "outputs",
    "placement",
    "shapes",
    "viewpoints",
]
