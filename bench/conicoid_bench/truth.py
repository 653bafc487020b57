"""The exact picture that all others are measured against, itself checked against exact arithmetic."""

from dataclasses import replace
from typing import Any

import numpy as np

from conicoid.engine import Renderer as Engine
from conicoid.verify import check, sampled_places, silhouettes
from conicoid_bench.engine import Conicoid
from conicoid_bench.picture import Picture
from conicoid_bench.scenes import BenchScene


class WrongTruth(Exception):
    """`exact` is not exact here, so that nothing can be measured against it."""


def truth(engine: Engine, bench: BenchScene, checked: int) -> tuple[Picture, dict[str, Any]]:
    """The exact picture, after pixels of it were checked against exact arithmetic; and the scene's facts for JSON.

    Raises:
        WrongTruth: one was not right.
    """
    job = Conicoid(engine, "exact").prepare(bench.scene)
    picture = job.picture(job.run())
    planes = {"Z": picture.depth, "id": picture.id}
    planes |= {f"N.{axis}": picture.normal[..., k] for k, axis in enumerate("XYZ")}
    places = sampled_places(planes, checked)
    output = replace(bench.scene.output, normal_space="world", normal_side="facing", background_depth=np.inf)
    verdict = check(replace(bench.scene, output=output), planes, bench.scene.camera.crop, places)
    if verdict.wrong:
        raise WrongTruth(f"{bench.name}: `exact` is wrong at {verdict.wrong} pixels; {verdict.differences[0]}")
    edge = silhouettes(planes)[tuple(places.T)]
    return picture, {
        "name": bench.name,
        "reason": bench.reason,
        "quadrics": len(bench.scene.quadrics),
        "width": bench.scene.camera.width,
        "height": bench.scene.camera.height,
        "hits": int(np.count_nonzero(picture.id)),
        "verified": {"pixels": verdict.pixels, "silhouette": int(edge.sum()), "hits": verdict.hits},
    }
