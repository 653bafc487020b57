"""What binary64 could not certify: surfaces that tie by construction, forms that vanish, and single pixels.

Casting lists the pixels where some decision or rounding is within its error bound. Where the hit is certain, and only
a value's rounding is not, double-double rounds it. The few other pixels are solved one by one in exact arithmetic.
Where many doubt what they hit, they have a common cause, which is settled once: surfaces that are the same set of
points get one class, so that casting orders them by the document; records of quadrics whose forms vanish, or nearly,
are rounded from exact rationals, so that zero is zero; then the frame is cast again.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.bins import Bins
from conicoid.exact import ExactForms, ExactPixel, ExactScene
from conicoid.scene import Scene
from conicoid.setup import Visible

# `reasons` and `kind` in kernels/tile.h and candidates.h.
_DOUBT_HIT: Final = 1
_SURFACE_OF_KIND: Final = np.array([0, 0, 1, 2])
_SMALLEST: Final = 2.0**-280

_ORTHOGRAPHIC: Final = 32

# Below this, solving pixels is quicker than casting again.
_FEW: Final = 256
# Exact forms take some 0.3 ms each; what is left over is solved pixel by pixel.
_MOST_AT_ONCE: Final = 4096

Planes = dict[str, NDArray[Any]]
Cast = Callable[[NDArray[np.int32]], tuple[Planes, NDArray[Any]]]
Refine = Callable[[Planes, NDArray[Any]], NDArray[np.bool_]]


def settle(scene: Scene, visible: Visible, bins: Bins, cast: Cast, refine: Refine) -> tuple[Planes, int, int]:
    """The exact planes of a frame, and how many of its pixels double-double rounded and the host solved.

    `cast` casts the frame given the slots' surface classes (`Caster.run`); `visible.general` is refined in place.
    `refine` rounds the values of pixels whose hit is certain and tells which it could (`Refinement.run`).
    """
    settlement = _Settlement(scene, visible, bins)
    if scene.output.precision == "exact":
        settlement.refine(_drowned(visible.general))
    planes, doubts = cast(settlement.classes)
    for step in (settlement.classify, settlement.refine_seen, settlement.classify):
        if np.count_nonzero(doubts["reasons"] & _DOUBT_HIT) <= _FEW:
            break
        if step(doubts):
            planes, doubts = cast(settlement.classes)
    known = (doubts["reasons"] & _DOUBT_HIT) == 0
    known[known] = refine(planes, doubts[known])
    for doubt in doubts[~known]:
        settlement.solve(planes, doubt)
    return planes, int(np.count_nonzero(known)), int(np.count_nonzero(~known))


class _Settlement:
    """One frame's exact arithmetic, and what it has found.

    Attributes:
        classes: (m, 3) int32 numbers of the slots' surfaces and caps, equal where they are the same set of points.
    """

    def __init__(self, scene: Scene, visible: Visible, bins: Bins) -> None:
        self._scene, self._visible, self._bins = scene, visible, bins
        self._exact = ExactScene(scene)
        self._numbers: dict[tuple[Any, ...], int] = {}
        self.classes = np.full((len(visible.quadric), 3), -1, dtype=np.int32)

    def classify(self, doubts: NDArray[Any]) -> bool:
        """Numbers the surfaces that tie somewhere; whether any two of them are the same."""
        tied = doubts[doubts["rival"] >= 0]
        hits = np.unique(np.concatenate([tied["winner"], tied["rival"]]))
        known = len(self._numbers)
        found = {(int(slot), int(surface)) for slot, surface in zip(hits >> 2, _SURFACE_OF_KIND[hits & 3], strict=True)}
        for slot, surface in sorted(found):
            key = self._exact.surface_key(int(self._visible.quadric[slot]), surface)
            self.classes[slot, surface] = self._numbers.setdefault(key, len(self._numbers))
        return len(found) > len(self._numbers) - known

    def refine_seen(self, doubts: NDArray[Any]) -> bool:
        """Refines the general records that pixels with doubtful hits may see; whether there are any."""
        doubts = doubts[(doubts["reasons"] & _DOUBT_HIT) != 0]
        tiles = np.unique(self._bins.tile_of(doubts["x"], doubts["y"]))
        slots = np.unique(np.concatenate([np.empty(0, np.int32), *(self._bins.slots(int(tile)) for tile in tiles)]))
        rows = ~self._visible.record[slots]
        self.refine(rows[rows >= 0].astype(np.intp))
        return bool((rows >= 0).any())

    def refine(self, rows: NDArray[np.intp]) -> None:
        """Rounds general records from exact forms."""
        quadric_of = self._visible.quadric[self._visible.record < 0]
        for row in rows[:_MOST_AT_ONCE].tolist():
            record, quadric = self._visible.general[row], int(quadric_of[row])
            # The kernels' forms are scaled to entries below 1, their directions by the unit.
            matrix_row = int(self._scene.quadrics.matrix_row[quadric])
            matrix = self._scene.quadrics.matrix[matrix_row] if matrix_row >= 0 else np.array([0.5])
            shrink = -int(np.frexp(np.abs(matrix).max())[1])
            with suppress(OverflowError):
                forms = self._exact.forms(quadric).about(*map(int, record["centre"]))
                _write_record(record, forms, shrink, self._visible.unit)

    def solve(self, planes: Planes, doubt: Any) -> None:
        """Writes one pixel of the planes."""
        x, y = int(doubt["x"]), int(doubt["y"])
        x0, y0 = self._scene.camera.crop[:2]
        if int(doubt["reasons"]) & _DOUBT_HIT:
            pixel = self._first_hit(x, y, float(doubt["depth"]))
        else:
            pixel = self._exact.pixel(x, y, [int(self._visible.quadric[int(doubt["winner"]) >> 2])])
        for channel in self._scene.output.channels:
            for name, value in self._exact.channel(channel, pixel).items():
                planes[name][y - y0, x - x0] = value
        if "A" in planes:
            planes["A"][y - y0, x - x0] = pixel is not None

    def _first_hit(self, x: int, y: int, depth: float) -> ExactPixel | None:
        """The pixel, looking behind the depth that casting found only where nothing is hit before it."""
        slots = self._bins.slots(int(self._bins.tile_of(x, y)))
        box = self._visible.box[slots]
        slots = slots[(box[:, 0] <= x) & (x < box[:, 2]) & (box[:, 1] <= y) & (y < box[:, 3])]
        depth *= 1 + 2.0**-20
        front = self._visible.nearest[slots] <= depth
        if not front.all() and depth > 0:
            pixel = self._exact.pixel(x, y, self._visible.quadric[slots[front]].tolist())
            if pixel is not None and pixel.z <= depth:
                return pixel
        return self._exact.pixel(x, y, self._visible.quadric[slots].tolist())


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
