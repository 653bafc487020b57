"""Conicoid itself, in each of its precisions."""

from dataclasses import replace

import numpy as np

from conicoid.engine import Frame
from conicoid.engine import Renderer as Engine
from conicoid.scene import Precision, Scene
from conicoid_bench.picture import Job, Picture


class Conicoid:
    """The engine with Z, N and id; set-up of every quadric and binning are part of every frame."""

    def __init__(self, engine: Engine, precision: Precision) -> None:
        self._engine, self._precision = engine, precision
        self.name = f"conicoid {precision}"

    def why_not(self, scene: Scene) -> str | None:  # noqa: ARG002
        """It renders every scene."""
        return None

    def prepare(self, scene: Scene) -> Job:
        """Only the output is chosen here."""
        output = replace(scene.output, channels=("Z", "N", "id"), precision=self._precision, data_window="full",
                         normal_space="world", normal_side="facing", background_depth=np.inf)  # fmt: skip
        asked = replace(scene, output=output)
        return Job(lambda: self._engine.render(asked), _picture)


def _picture(frame: Frame) -> Picture:
    # The planes last until the next render only.
    normal = np.stack([frame.planes[f"N.{axis}"] for axis in "XYZ"], axis=-1)
    return Picture(frame.planes["Z"].copy(), frame.planes["id"].copy(), normal, frame.refined, frame.settled)
