"""Per quadric: bounds, culling, depth order, and the records that casting reads."""

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pyopencl
from numpy.typing import NDArray

from conicoid.extent import Model
from conicoid.memory import Queue
from conicoid.program import build
from conicoid.scene import Camera, Floats
from conicoid.shapes import SHAPES
from conicoid.view import View

_CULLED: Final = 0
_SIMPLE: Final = 1
# The records of kernels/records.h, member by member.
SLOT: Final = np.dtype(
    [
        ("s", "f8", 6), ("b", "f8", 3), ("s_error", "f4"), ("slop", "f4"), ("key_error", "f4"), ("n_error", "f4"),
        ("root_norm", "f4"), ("nearest", "f4"), ("centre", "i4", 2), ("box", "i4", 4), ("general", "i4"),
        ("quadric", "i4"),
    ],
    align=True,
)  # fmt: skip
GENERAL: Final = np.dtype(
    [
        ("slab", "f8", (3, 4)), ("centre", "i4", 2), ("flags", "i4"), ("placed", "i4"), ("clip_start", "i4", 4),
        ("clip_count", "i4", 4), ("drowned", "i4"), ("s", "f8", 6), ("a", "f8", 6), ("b", "f8", 3), ("c", "f8", 6),
        ("range", "f8", (2, 3)), ("end", "f8", 2), ("cap", "f8", (2, 6)), ("y", "f8", (3, 3)), ("kappa", "f8"),
        ("fixed_norm", "f8"), ("moving_norm", "f8", 3), ("moment_norm", "f8", 3), ("form_sum", "f8"),
        ("spatial_sum", "f8"), ("compound_sum", "f8"), ("x", "f8", (3, 3)), ("moment", "f8", (3, 3)),
        ("form", "f8", 10), ("normal", "f8", (3, 3)), ("sheet", "f8", 3), ("face", "f8", (2, 3)),
    ],
    align=True,
)  # fmt: skip
CLIP: Final = np.dtype([("offset", "f8", 3), ("slope", "f8", 3)])
PLANE: Final = np.dtype([("lead", "f8", 3), ("cluster", "i4")], align=True)
_STEPS: Final = 65535.0


def shape_forms() -> Floats:
    """(14, 10) upper triangles of every shape's form in parameter space, rows as `shapes.SHAPES`."""
    forms = np.zeros((len(SHAPES), 10))
    for shape in SHAPES:
        forms[shape.code, [0, 4, 7]] = shape.squares
        forms[shape.code, 8] = shape.linear_z / 2
        forms[shape.code, 9] = shape.constant
    return forms


def scaled(matrix: Floats) -> Floats:
    """Each (4, 4) form times the power of two that brings its largest entry into [1/2, 1): the same surface."""
    exponent = np.frexp(np.abs(matrix).max(axis=(1, 2), initial=0))[1]
    scaled: Floats = np.ldexp(matrix, -exponent[:, None, None])
    return scaled


def _in_depth_order(seen: NDArray[np.int32], nearest: Floats) -> NDArray[np.int32]:
    """Quadrics by the lower bounds of their depth, in the document's order where these are as good as equal."""
    depth = nearest.take(seen)
    if not len(seen):
        return seen
    low, high = float(depth.min()), float(depth.max())
    with np.errstate(invalid="ignore", over="ignore"):
        # Sixteen bits are enough for casting to stop in time, and numpy sorts them by radix.
        place = (depth - low) * (_STEPS / (high - low)) if high > low else np.zeros(len(seen))
    ordered: NDArray[np.int32] = seen[np.argsort(place.astype(np.uint16), kind="stable")]
    return ordered


def _unit(depth: Floats) -> float:
    """A power of two near the depths' median, by a sample."""
    sample = np.sort(depth[:: max(1, len(depth) // 1024)])
    sample = sample[sample > 0]
    return 2.0 ** min(max(math.frexp(sample[len(sample) // 2])[1], -900), 900) if len(sample) else 1.0


def _keys(depth: Floats, unit: float, *, orthographic: bool) -> NDArray[np.float32]:
    """The kernels' keys (1 / t or -t, t in units) of depths, no smaller."""
    with np.errstate(divide="ignore", over="ignore"):
        t = depth * ((1 - 2.0**-20) / unit)
        return (-t if orthographic else 1 / t).astype(np.float32)


@dataclass(frozen=True)
class Visible:
    """The quadrics a frame can see, in depth order ("slots"), and their records on the device.

    Attributes:
        quadric: (m,) int32, index in the document of each slot.
        box: (m, 4) int32 pixel boxes [x0, y0, x1, y1), half-open.
        nearest: (m,) float64, lower bounds of the depth of each slot and all behind it, world units, ascending.
        record: (m,) int32, ~row of `general`; not negative where there is none.
        slots, general, clips: records, of SLOT, GENERAL and CLIP.
        place: (m, 4) int32 by slot and kind of hit (kernels/candidates.h): the row of `planes`, -1 where nothing is
            known. Surfaces of one place are the same set of points, and tie where both are hit.
        planes: what is known of places, of PLANE.
        unit: power of two near the scene's depth; records hold t / unit.
        accurate: how many closed surfaces double-double set up, because binary64 could not bound them well enough.
    """

    quadric: NDArray[np.int32]
    box: NDArray[np.int32]
    nearest: Floats
    record: NDArray[np.int32]
    slots: NDArray[Any]
    general: NDArray[Any]
    clips: NDArray[Any]
    place: NDArray[np.int32]
    planes: NDArray[Any]
    unit: float
    accurate: int


class Setup:
    """The set-up kernels of one device."""

    def __init__(self, queue: Queue) -> None:
        self._queue = queue
        bounding = build(queue.context, ["records.h", "projected.h", "bounds.cl", "slabs.cl"])
        self._bound, self._closely = bounding.bound_quadrics, bounding.bound_closely
        program = build(queue.context, [
            "dd.h", "records.h", "family.h", "simple_forms.h", "setup_quick.cl", "setup_simple.cl", "setup_general.cl",
        ])  # fmt: skip
        self._quickly, self._simple = program.set_up_quickly, program.set_up_simple
        self._general, self._clips = program.set_up_general, program.set_up_clips
        self._forms = queue.read_only(shape_forms())

    def run(self, model: Model, camera: Camera, view: View, *, want_back: bool) -> Visible:
        """Bounds every quadric, drops what cannot be seen, and sets up the rest.

        With `want_back` the farthest hit is asked too, which simple records do not have.
        """
        queue, quadrics = self._queue, model.quadrics
        world = queue.read_only(quadrics.world_from_object)
        rays = queue.read_only(view.rays)
        box, middle, nearest, path = self._bounds(model, camera, view, world, want_back)

        seen = _in_depth_order(np.flatnonzero(path != _CULLED).astype(np.int32), nearest)
        # Of each slot and all behind it: casting stops by it.
        nearest = np.minimum.accumulate(nearest.take(seen)[::-1])[::-1]
        unit = _unit(nearest)
        nearest_key = _keys(nearest, unit, orthographic=view.orthographic)
        slots, slot_of = queue.kept("slots", len(seen), SLOT), queue.kept("slot_of", len(quadrics), np.int32)
        slot_of[seen] = np.arange(len(seen), dtype=np.int32)
        general_slots = np.flatnonzero(path.take(seen) != _SIMPLE)
        record = np.zeros(len(seen), dtype=np.int32)
        record[general_slots] = ~np.arange(len(general_slots), dtype=np.int32)
        rows = np.flatnonzero(path == _SIMPLE).astype(np.int32)

        radii, centres = queue.read_only(quadrics.radii), queue.read_only(middle)
        general = queue.kept("general", len(general_slots), GENERAL)
        clips = np.empty(len(quadrics.clip), dtype=CLIP)
        orthographic = np.int32(view.orthographic)
        again = np.empty(0, dtype=np.int32)
        if len(rows):
            open_rows = queue.kept("open_rows", len(rows), np.uint8)
            axis = np.hypot.reduce(view.image_rows, axis=1) * [1, 1, 1 / unit if view.orthographic else 1]
            inputs = [queue.read_only(rows), queue.read_only(slot_of), world, radii, centres, rays, np.float64(unit),
                      orthographic, view.principal, np.append(axis, 0.0), queue.read_only(box),
                      np.array(camera.crop, dtype=np.int32), queue.read_only(nearest_key),
                      queue.in_place(slots)]  # fmt: skip
            queue.run(self._quickly, -(-len(rows) // 4), np.int32(len(rows)), *inputs, queue.in_place(open_rows))
            again = np.flatnonzero(open_rows).astype(np.int32)
            if len(again):
                queue.run(self._simple, -(-len(again) // 4), np.int32(len(again)), queue.read_only(again), *inputs)
        if len(general_slots):
            rows = seen[general_slots]
            queue.run(self._general, -(-len(rows) // 4), np.int32(len(rows)), queue.read_only(rows), world, radii,
                      queue.read_only(quadrics.shape), self._forms, queue.read_only(quadrics.matrix_row),
                      queue.read_only(scaled(quadrics.matrix)), queue.read_only(quadrics.z_range),
                      queue.read_only(quadrics.capped.view(np.uint8)), queue.read_only(model.extent.flags),
                      queue.read_only(quadrics.clip_start), centres, rays, np.float64(unit), orthographic,
                      queue.read_only(view.target), queue.in_place(general))  # fmt: skip
            extent = model.extent
            queue.run(self._closely, -(-len(rows) // 4), np.int32(len(rows)), queue.read_only(rows), world,
                      queue.read_only(extent.centre), queue.read_only(extent.half), queue.read_only(extent.kind),
                      queue.read_only(view.image_rows), queue.read_only(view.origin), view.principal, orthographic,
                      queue.in_place(general))  # fmt: skip
            slots["box"][general_slots], slots["nearest"][general_slots] = box[rows], nearest_key[general_slots]
            slots["general"][general_slots], slots["quadric"][general_slots] = np.arange(len(rows)), rows
        if len(quadrics.clip):
            queue.run(self._clips, -(-len(quadrics.clip) // 4), np.int32(len(quadrics.clip)),
                      queue.read_only(quadrics.clip), rays, np.float64(unit), queue.in_place(clips))  # fmt: skip
        place, planes = np.full((len(seen), 4), -1, dtype=np.int32), np.empty(0, dtype=PLANE)
        return Visible(seen, box.take(seen, axis=0), nearest, record, slots, general, clips, place, planes, unit,
                       len(again))  # fmt: skip

    def _bounds(
        self, model: Model, camera: Camera, view: View, world: "pyopencl.Buffer", want_back: bool
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats, NDArray[np.uint8]]:
        queue, count, extent = self._queue, len(model.quadrics), model.extent
        box = queue.kept("box", (count, 4), np.int32)
        middle = queue.kept("middle", (count, 2), np.int32)
        nearest = queue.kept("nearest", count, np.float64)
        path = queue.kept("path", count, np.uint8)
        if count:
            queue.run(self._bound, -(-count // 4), np.int32(count), world, queue.read_only(extent.centre),
                      queue.read_only(extent.half), queue.read_only(extent.kind),
                      queue.read_only(extent.whole.view(np.uint8)), queue.read_only(view.image_rows),
                      queue.read_only(view.origin), view.principal, np.int32(view.orthographic),
                      np.array(camera.crop, dtype=np.int32), np.array([camera.width, camera.height], dtype=np.int32),
                      np.float64(camera.near), np.float64(camera.far), np.int32(want_back),
                      queue.in_place(box), queue.in_place(middle), queue.in_place(nearest),
                      queue.in_place(path))  # fmt: skip
        return box, middle, nearest, path
