"""What every renderer here makes of a scene, and what it is asked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Scene


@dataclass(frozen=True)
class Picture:
    """One image.

    Attributes:
        depth: (h, w) float32, planar, inf on a miss.
        id: (h, w) uint32, 0 on a miss.
        normal: (h, w, 3) float32, unit, world, facing the camera; 0 on a miss.
        refined, settled: pixels that double-double rounded, and that exact arithmetic settled on the host.
    """

    depth: NDArray[np.float32]
    id: NDArray[np.uint32]
    normal: NDArray[np.float32]
    refined: int = 0
    settled: int = 0


@dataclass(frozen=True)
class Job:
    """A scene made ready.

    Attributes:
        run: renders it once; only this is timed. It returns when the result is complete.
        picture: makes a picture of what `run` returned.
        build: does again what a moved camera or quadric asks for before `run`: matrices, boxes, lists, hierarchies.
    """

    run: Callable[[], Any]
    picture: Callable[[Any], Picture]
    build: Callable[[], object] = lambda: None


class Renderer(Protocol):
    """Something that renders quadrics."""

    name: str

    def why_not(self, scene: Scene) -> str | None:
        """Why it cannot render a scene, in a few words; None if it can."""

    def prepare(self, scene: Scene) -> Job:
        """Everything that a program would do once, not in every frame."""
