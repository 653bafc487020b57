"""One job: rendered in `exact`, with and without the last hit, with ids alone, and judged pixel by pixel."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from conicoid.engine import Frame, Renderer
from conicoid.scene import Channel
from tests.oracle.answers import Answers
from tests.oracle.judge import normal_error, position_error
from tests.oracle.promise import broken
from tests.scenes import as_scene
from tests.stress.workload import Job


@dataclass(frozen=True)
class Result:
    """Counts of one job.

    Attributes:
        pixels: distinct pixels that the reference answered; hits: those that hit.
        rendered: pixels judged, one for each of `frames` renderings.
        wrong: pixels by broken promise, over all renderings.
        refined, settled: pixels of the first rendering that double-double rounded and the host decided, of `size`.
        normal, position: worst errors, in 2^-23 and in units of the largest component.
        places: the first few pixels that are wrong.
    """

    group: str
    name: str
    seed: int
    pixels: int
    hits: int
    frames: int
    wrong: dict[str, int]
    refined: int
    settled: int
    size: int
    normal: float
    position: float
    places: list[tuple[int, int]]


def check(job: Job, renderer: Renderer) -> Result:
    """Renders one job's scene and holds it to the promise of `exact`."""
    scene = as_scene(job.document)
    output = replace(scene.output, precision="exact", data_window="full", background_depth=float("inf"))
    channel_sets: list[tuple[Channel, ...]] = [output.channels]
    if "ZBack" in output.channels and len(output.channels) > 1:
        channel_sets.append(tuple(channel for channel in output.channels if channel != "ZBack"))
    channel_sets.append(("id", "A"))
    reference = Answers(replace(scene, output=output))
    wrong: dict[str, int] = {}
    places: list[tuple[int, int]] = []
    rows, columns = np.empty(0, int), np.empty(0, int)
    refined = settled = size = 0
    normal = position = 0.0
    for turn, channels in enumerate(channel_sets):
        frame = renderer.render(replace(scene, output=replace(output, channels=channels)))
        if turn == 0:
            rows, columns = chosen(job, frame)
            x0, y0 = frame.window[:2]
            truth = reference.pixels([(x0 + int(x), y0 + int(y)) for x, y in zip(columns, rows, strict=True)])
            refined, settled, size = frame.refined, frame.settled, next(iter(frame.planes.values())).size
        planes = {name: plane[rows, columns] for name, plane in frame.planes.items()}
        for promise, pixels in broken(planes, truth).items():
            wrong[promise] = wrong.get(promise, 0) + int(pixels.sum())
            places += [(int(columns[k]), int(rows[k])) for k in np.flatnonzero(pixels)[:3]]
        if "N.X" in planes:
            normal = max(normal, float(normal_error(planes, truth).max() * 2**23))
        if "P.X" in planes:
            position = max(position, float(position_error(planes, truth).max()))
    counts = len(rows), int(truth.hit.sum()), len(channel_sets)
    return Result(job.group, job.name, job.seed, *counts, wrong, refined, settled, size, normal, position, places[:5])


def chosen(job: Job, frame: Frame) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns to check: all, or a sample of which half lie beside a change of id."""
    if not job.sample:
        rows, columns = np.indices(next(iter(frame.planes.values())).shape)
        return rows.ravel(), columns.ravel()
    ids = frame.planes["id"].astype(np.int64)
    edge = np.zeros(ids.shape, dtype=bool)
    edge[:, 1:] |= ids[:, 1:] != ids[:, :-1]
    edge[1:, :] |= ids[1:, :] != ids[:-1, :]
    draw = np.random.default_rng(job.seed)
    edges = np.flatnonzero(edge)
    picked = draw.choice(edges, min(job.sample // 2, len(edges)), replace=False)
    others = draw.choice(ids.size, job.sample - len(picked), replace=False)
    return np.divmod(np.unique(np.concatenate([picked, others])), ids.shape[1])
