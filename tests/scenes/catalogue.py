"""Small scenes by name, each a document with the reason why it is here."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from conicoid.document import parse
from conicoid.scene import Scene

Document = dict[str, Any]

CHANNELS = ["Z", "T", "ZBack", "N", "P", "id", "A"]
PROJECTIONS = ("pinhole", "orthographic")


@dataclass(frozen=True)
class SmallScene:
    """A named document.

    Attributes:
        name: unique, in snake case.
        reason: what would break here first.
        document: the scene, as a user writes it.
        only_exact: some of its pixels are decided by less than binary64 can tell: `float64` does not promise them.
    """

    name: str
    reason: str
    document: Document
    only_exact: bool = False


CATALOGUE: dict[str, SmallScene] = {}


def add(name: str, reason: str, document: Document, only_exact: bool = False) -> None:
    """Enter one scene."""
    assert name not in CATALOGUE, f"{name} is in the catalogue already"
    CATALOGUE[name] = SmallScene(name, reason, document, only_exact)


def scene(make: Callable[[], Document]) -> Callable[[], Document]:
    """Enter the scene that a function makes: its name, and its docstring as the reason."""
    add(make.__name__, make.__doc__ or "", make())
    return make


def only_exact(make: Callable[[], Document]) -> Callable[[], Document]:
    """Enter a scene with pixels that binary64 cannot decide."""
    add(make.__name__, make.__doc__ or "", make(), only_exact=True)
    return make


def document(quadrics: list[Document], camera: Document, **output: object) -> Document:
    """A whole document, with every channel unless `output` says otherwise."""
    return {"conicoid": 1, "quadrics": quadrics, "camera": camera, "output": {"channels": CHANNELS, **output}}


def pinhole(**keys: object) -> Document:
    """A camera at the origin that sees 4 units of height at z = -4; its rays are dyadic."""
    return {"width": 24, "height": 16, "fx": 16, "fy": 16, **keys}


def orthographic(**keys: object) -> Document:
    """A camera at the origin that sees 4 units of height; 4 pixels per unit."""
    return {"projection": "orthographic", "width": 24, "height": 16, "view_height": 4, **keys}


def either(projection: str, **keys: object) -> Document:
    """One of the two cameras above."""
    return pinhole(**keys) if projection == "pinhole" else orthographic(**keys)


def as_scene(document: Document) -> Scene:
    """The document as the engine gets it, through the parser."""
    return parse(json.dumps(document).encode()).resolve()
