"""What the long run renders: every catalogued scene, small and enlarged, then random scenes until there are enough."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tests.scenes import CATALOGUE
from tests.scenes.catalogue import CHANNELS, PROJECTIONS, Document, document
from tests.scenes.stress_catalogue import STRESS
from tests.scenes.stress_mix import CURVED, Mix

FACTOR = 3


class Job(NamedTuple):
    """One scene to check.

    Attributes:
        group: heading in the report.
        name: of the scene.
        seed: of what is random in it; -1 where nothing is.
        document: the scene.
        sample: how many pixels to check, half of them beside edges; 0 for all.
    """

    group: str
    name: str
    seed: int
    document: Document
    sample: int = 0


def jobs(seed: int) -> Iterator[Job]:
    """Fixed scenes first, then random ones without end; `seed` is that of the first random one."""
    for name, scene in STRESS.items():
        yield Job("Stress scenes", name, -1, scene.document)
    for name, scene in CATALOGUE.items():
        yield Job("Catalogue", name, -1, scene.document)
    for name, scene in STRESS.items():
        yield Job(f"Stress scenes, {FACTOR} times the resolution", name, -1, enlarged(scene.document, FACTOR))
    for name, scene in CATALOGUE.items():
        if "crop" not in scene.document["camera"]:
            larger = enlarged(scene.document, FACTOR)
            yield Job(f"Catalogue, {FACTOR} times the resolution", name, -1, larger)
    while True:
        yield from random_jobs(seed)
        seed += 1


def enlarged(original: Document, factor: int) -> Document:
    """The same view in more pixels; an odd factor keeps pixel centres where they were, and adds others."""
    camera = dict(original["camera"])
    for size, centre in (("width", "cx"), ("height", "cy")):
        if centre in camera:
            camera[centre] *= factor
        camera[size] *= factor
    for key in ("fx", "fy"):
        if key in camera:
            camera[key] *= factor
    return {**original, "camera": camera}


def random_jobs(seed: int) -> Iterator[Job]:
    """One scene of each random kind."""
    for projection in PROJECTIONS:
        quadrics, camera, sides = Mix(seed).scene(12, projection, 64, 48)
        yield Job("Random mixes", f"mix_{projection}", seed, document(quadrics, camera, **sides))
    yield Job("Crowds of small balls", "balls", seed, balls(seed, 80, 160, 120))
    yield Job("Far and tiny", "far_and_tiny", seed, far_and_tiny(seed))
    if seed % 4 == 0:
        mix = Mix(seed, spread=3.0, shapes=CURVED)
        quadrics, camera, sides = mix.scene(150, PROJECTIONS[seed // 4 % 2], 480, 360)
        yield Job("Large mixes, sampled", "large_mix", seed, document(quadrics, camera, **sides), sample=1500)
        yield Job("Large crowds, sampled", "large_crowd", seed, balls(seed, 3000, 1920, 1080), sample=3000)


def balls(seed: int, count: int, width: int, height: int) -> Document:
    """Balls and ellipsoids a few pixels wide, every tenth a copy of the one before."""
    draw = np.random.default_rng(seed)
    quadrics: list[Document] = []
    size = 2.0 / count**0.5
    for k in range(count):
        if k % 10 == 9:
            quadrics.append(quadrics[-1])
            continue
        centre = draw.uniform((-2.5, -1.8, -7), (2.5, 1.8, -4)).tolist()
        radii = draw.uniform(0.3 * size, size, 3).tolist()
        quadrics.append({"shape": "ellipsoid", "center": centre, "radii": radii,
                         "rotation": draw.uniform(-1, 1, 4).tolist()})  # fmt: skip
    camera = {"width": width, "height": height, "fx": width, "fy": width}
    return document(quadrics, camera, channels=[channel for channel in CHANNELS if channel != "ZBack"])


def far_and_tiny(seed: int) -> Document:
    """One quadric of size r at distance D, D/r from 1e2 to 1e12, filling the image, all of it far from the origin."""
    draw = np.random.default_rng([seed, 7])
    distance, ratio = 10.0 ** draw.uniform(-3, 6), 10.0 ** draw.uniform(2, 12)
    radius = distance / ratio
    eye = draw.uniform(-1, 1, 3) * distance * 10.0 ** draw.uniform(-6, 8)
    centre = eye + draw.uniform((-1, -1, -2), (1, 1, -1)) * distance
    shape = str(draw.choice(["ellipsoid", "cylinder", "cone", "hyperboloid_one_sheet"]))
    radii = draw.uniform(0.3, 1, 3) * (1 if shape == "cone" else radius)
    quadric: Document = {
        "shape": shape,
        "radii": radii[: 2 if shape in {"cylinder", "cone"} else 3].tolist(),
        "center": centre.tolist(),
        "rotation": draw.uniform(-1, 1, 4).tolist(),
    }
    if shape != "ellipsoid":
        quadric |= {"z_range": [-radius, 0.8 * radius], "capped": bool(draw.random() < 0.7)}
    # The lens is shifted to where the centre, as rounded, is seen.
    x, y, z = centre - eye
    focal = 24 * ratio
    pose = np.eye(4)
    pose[:3, 3] = eye
    camera = {"width": 64, "height": 48, "fx": focal, "fy": focal, "cx": 32 + focal * x / z, "cy": 24 - focal * y / z,
              "world_from_camera": pose.tolist()}  # fmt: skip
    return document([quadric], camera)
