"""What binary64 could not certify: surfaces that tie by construction, forms that vanish, and single pixels.

Casting lists the pixels where some decision or rounding is within its error bound. Few pixels are solved one by one in
exact arithmetic. Many have a common cause, which is settled once: surfaces that are the same set of points get one
class, so that casting orders them by the document; records of quadrics whose forms vanish, or nearly, are rounded
from exact rationals, so that zero is zero; then the frame is cast again.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.bins import TILE, Bins
from conicoid.exact import ExactForms, ExactPixel, ExactScene
from conicoid.scene import Scene
from conicoid.setup import Visible

# `reasons` and `kind` in kernels/tile.h and candidates.h.
_DOUBT_HIT: Final = 1
# What else makes a channel doubtful; every reason settles the depths.
_SETTLES: Final = {"N": 4, "P": 8}
_SURFACE_OF_KIND: Final = np.array([0, 0, 1, 2])
_SMALLEST: Final = 2.0**-280

_ORTHOGRAPHIC: Final = 32

# Below this, solving pixels is quicker than casting again.
_FEW: Final = 256
# Exact forms take some 0.3 ms each; what is left over is solved pixel by pixel.
_MOST_AT_ONCE: Final = 4096

Planes = dict[str, NDArray[Any]]
Cast = Callable[[NDArray[np.int32] | None], tuple[Planes, NDArray[Any]]]


def settle(scene: Scene, visible: Visible, bins: Bins, cast: Cast) -> tuple[Planes, int]:
    """The exact planes of a frame, and how many of its pixels were solved on the host.

    `cast` casts the frame given the slots' surface classes (`Caster.run`); `visible.general` is refined in place.
    """
    exact = ExactScene(scene)
    classes: NDArray[np.int32] | None = None
    if scene.output.precision == "exact":
        _refine(exact, scene, visible, _drowned(visible.general)[:_MOST_AT_ONCE])
    planes, doubts = cast(classes)
    if _many(doubts):
        classes = _surface_classes(exact, visible, doubts)
        if classes is not None:
            planes, doubts = cast(classes)
    if _many(doubts):
        _refine(exact, scene, visible, _general_rows(visible, bins, doubts))
        planes, doubts = cast(classes)
        again = _surface_classes(exact, visible, doubts) if _many(doubts) else None
        if again is not None:
            planes, doubts = cast(again if classes is None else np.maximum(classes, again))
    x0, y0 = scene.camera.crop[:2]
    for doubt in doubts:
        _solve(exact, scene, visible, bins, planes, doubt, (int(doubt["y"]) - y0, int(doubt["x"]) - x0))
    return planes, len(doubts)


def _many(doubts: NDArray[Any]) -> bool:
    return np.count_nonzero(doubts["reasons"] & _DOUBT_HIT) > _FEW


def _surface_classes(exact: ExactScene, visible: Visible, doubts: NDArray[Any]) -> NDArray[np.int32] | None:
    """(m, 3) classes of the slots' surfaces and caps that tie somewhere; None where no two are the same."""
    tied = doubts[doubts["rival"] >= 0]
    hits = np.unique(np.concatenate([tied["winner"], tied["rival"]]))
    slots, surfaces = hits >> 2, _SURFACE_OF_KIND[hits & 3]
    numbers: dict[tuple[Any, ...], int] = {}
    classes = np.full((len(visible.quadric), 3), -1, dtype=np.int32)
    for slot, surface in sorted({(int(slot), int(surface)) for slot, surface in zip(slots, surfaces, strict=True)}):
        key = exact.surface_key(int(visible.quadric[slot]), surface)
        classes[slot, surface] = numbers.setdefault(key, len(numbers))
    return classes if 0 < len(numbers) < np.count_nonzero(classes >= 0) else None


def _drowned(general: NDArray[Any]) -> NDArray[np.intp]:
    """Rows whose a, b, c or S is no larger than what set-up may have lost: exactly zero, more often than not.

    A paraboloid seen along its axis has a = 0 at every pixel, an eye on a surface c = 0, a cylinder seen end-on both
    b = 0 and S = 0.
    """
    largest = {name: np.abs(general[name]).max(axis=1, initial=0) for name in ("a", "b", "c", "s")}
    fixed, moving, moment = general["fixed_norm"], general["moving_norm"][:, 2], general["moment_norm"].max(axis=1)
    orthographic = (general["flags"] & _ORTHOGRAPHIC) != 0
    x, y = np.where(orthographic, moving, fixed), np.where(orthographic, fixed, moving)
    with np.errstate(all="ignore"):
        unit = 2.0**-89 * general["kappa"]
        drowned = largest["a"] <= unit * general["spatial_sum"] * y * y
        drowned |= largest["b"] <= unit * general["form_sum"] * x * y
        drowned |= largest["c"] <= unit * general["form_sum"] * x * x
        drowned |= largest["s"] <= unit * general["compound_sum"] * (2 * moment + unit * x * y) * x * y
    rows: NDArray[np.intp] = np.flatnonzero(drowned & (general["spatial_sum"] > 0))
    return rows


def _general_rows(visible: Visible, bins: Bins, doubts: NDArray[Any]) -> NDArray[np.intp]:
    """The general records that pixels with doubtful hits may see."""
    doubts = doubts[(doubts["reasons"] & _DOUBT_HIT) != 0]
    tiles = np.unique((doubts["y"] // TILE - bins.origin[1]) * bins.columns + (doubts["x"] // TILE - bins.origin[0]))
    slots = np.unique(np.concatenate([np.empty(0, np.int32), *(bins.slots(int(tile)) for tile in tiles)]))
    rows = ~visible.record[slots]
    return rows[rows >= 0].astype(np.intp)[:_MOST_AT_ONCE]


def _refine(exact: ExactScene, scene: Scene, visible: Visible, rows: NDArray[np.intp]) -> None:
    """Rounds general records from exact forms."""
    quadric_of = visible.quadric[visible.record < 0]
    for row in rows.tolist():
        record, quadric = visible.general[row], int(quadric_of[row])
        # The kernels' forms are scaled to entries below 1, their directions by the unit.
        matrix_row = int(scene.quadrics.matrix_row[quadric])
        shrink = -int(np.frexp(np.abs(scene.quadrics.matrix[matrix_row]).max())[1]) if matrix_row >= 0 else 0
        with suppress(OverflowError):
            _write_record(record, exact.forms(quadric).about(*map(int, record["centre"])), shrink, visible.unit)


def _write_record(record: Any, forms: ExactForms, shrink: int, unit: float) -> None:
    """Rounds every polynomial that decides; a record out of range (`workable` in family.h) stays in doubt."""
    per_unit = int(np.log2(unit))
    rounded = {
        "a": forms.a.rounded(shrink + 2 * per_unit),
        "b": forms.b.rounded(shrink + per_unit),
        "c": forms.c.rounded(shrink),
        "s": forms.s.rounded(2 * (shrink + per_unit)),
    }
    height = forms.height.rounded(per_unit)
    ends = [offset.rounded() for offset in forms.range]
    caps = [cap.rounded(shrink + 2 * per_unit) for cap in forms.cap]
    sizes = np.abs(np.concatenate([*rounded.values(), height, *ends, *caps, record["x"].ravel(), record["y"].ravel()]))
    if not ((sizes == 0) | ((sizes > _SMALLEST) & (sizes < 1 / _SMALLEST))).all():
        return
    for name, values in rounded.items():
        record[name] = values
    record["y"][2] = height
    for side, (end, cap) in enumerate(zip(ends, caps, strict=True)):
        record["range"][side], record["cap"][side] = end, cap
    # No noise of set-up is left.
    record["kappa"], record["moment_norm"] = 0.0, 0.0


def _solve(
    exact: ExactScene, scene: Scene, visible: Visible, bins: Bins, planes: Planes, doubt: Any, place: tuple[int, int]
) -> None:
    """Writes one pixel of the planes."""
    x, y = int(doubt["x"]), int(doubt["y"])
    tile = (y // TILE - bins.origin[1]) * bins.columns + (x // TILE - bins.origin[0])
    slots = bins.slots(tile)
    box = visible.box[slots]
    slots = slots[(box[:, 0] <= x) & (x < box[:, 2]) & (box[:, 1] <= y) & (y < box[:, 3])]
    pixel = _first_hit(exact, visible, slots, doubt, (x, y))
    reasons = int(doubt["reasons"])
    for channel in scene.output.channels:
        # Where only a depth's rounding was in doubt the normal and position stay what casting makes of its winner.
        if not reasons & (_DOUBT_HIT | _SETTLES.get(channel, reasons)):
            continue
        for name, value in exact.channel(channel, pixel).items():
            planes[name][place] = value
    if "A" in planes:
        planes["A"][place] = pixel is not None


def _first_hit(
    exact: ExactScene, visible: Visible, slots: NDArray[np.int32], doubt: Any, place: tuple[int, int]
) -> ExactPixel | None:
    """The pixel, looking behind the depth that casting found only where nothing is hit before it."""
    depth = float(doubt["depth"]) * (1 + 2.0**-20)
    front = visible.nearest[slots] <= depth
    if not front.all() and depth > 0:
        pixel = exact.pixel(*place, visible.quadric[slots[front]].tolist())
        if pixel is not None and pixel.z <= depth:
            return pixel
    return exact.pixel(*place, visible.quadric[slots].tolist())
