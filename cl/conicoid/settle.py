"""What binary64 could not certify: surfaces that tie by construction, forms that vanish, and single pixels.

Casting lists the pixels where some decision or rounding is within its error bound. Where the hit is certain, and only
a value's rounding is not, double-double rounds it. The few other pixels are solved one by one in exact arithmetic.
Where many doubt what they hit, they have a common cause, which is settled once: surfaces that are the same set of
points, and planes that meet other planes, are told where they are (places.py); records of quadrics whose forms vanish,
or nearly, are rounded from exact rationals, so that zero is zero; then the frame is cast again.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.bins import Bins
from conicoid.exact import ExactForms, ExactPixel, ExactScene
from conicoid.places import SHEETS, Places
from conicoid.scene import Scene
from conicoid.setup import Visible

# `reasons` and `kind` in kernels/tile.h and candidates.h.
_DOUBT_HIT: Final = 1
_SURFACE_OF_KIND: Final = np.array([0, 0, 1, 2])
# The kinds of hits on a surface and its caps.
_KINDS: Final = ((0, 1), (2,), (3,))
_SMALLEST: Final = 2.0**-280

_HAS_CAPS: Final = 2
_ALWAYS_REAL: Final = 4

# Below this, solving pixels is quicker than casting again.
_FEW: Final = 256
# Exact forms take some 0.3 ms each; what is left over is solved pixel by pixel.
_MOST_AT_ONCE: Final = 4096

Planes = dict[str, NDArray[Any]]
Cast = Callable[[Visible], tuple[Planes, NDArray[Any]]]
Refine = Callable[[Planes, NDArray[Any]], NDArray[np.bool_]]


def settle(scene: Scene, visible: Visible, bins: Bins, cast: Cast, refine: Refine) -> tuple[Planes, int, int]:
    """The exact planes of a frame, and how many of its pixels double-double rounded and the host solved.

    `cast` casts the frame given its records (`Caster.run`); `visible.general` is refined in place.
    `refine` rounds the values of pixels whose hit is certain and tells which it could (`Refinement.run`).
    """
    settlement = _Settlement(scene, visible, bins)
    if scene.output.precision == "exact":
        settlement.refine(np.flatnonzero(visible.general["drowned"]))
    planes, doubts = cast(settlement.visible)
    for step in (settlement.place, settlement.refine_seen, settlement.place):
        if np.count_nonzero(doubts["reasons"] & _DOUBT_HIT) <= _FEW:
            break
        if step(doubts):
            planes, doubts = cast(settlement.visible)
    known = settlement.known(doubts)
    known[known] = refine(planes, doubts[known])
    for doubt in doubts[~known]:
        settlement.solve(planes, doubt)
    return planes, int(np.count_nonzero(known)), int(np.count_nonzero(~known))


class _Settlement:
    """One frame's exact arithmetic, and what it has found."""

    def __init__(self, scene: Scene, visible: Visible, bins: Bins) -> None:
        self._scene, self._bins = scene, bins
        self._exact = ExactScene(scene)
        self._places = Places(visible, self._exact, scene.camera)

    @property
    def visible(self) -> Visible:
        """The records with what has been found."""
        return self._places.visible

    def place(self, doubts: NDArray[Any]) -> bool:
        """Places what is flat where hits are doubtful, and surfaces that tie there; whether that may decide any."""
        before = self.visible.place.copy()
        slots = self._seen_general(doubts)
        flat = (self.visible.general["flags"][~self.visible.record[slots]] & (_HAS_CAPS | _ALWAYS_REAL)) != 0
        unplaced = self.visible.general["placed"][~self.visible.record[slots]] == 0
        some_flat = self._places.add_flat(slots[flat & unplaced][:_MOST_AT_ONCE].tolist())
        for slot, surface in self._tied(doubts):
            if (self.visible.place[slot, _KINDS[surface]] < 0).all():
                key = self._exact.surface_key(int(self.visible.quadric[slot]), surface)
                self._places.name(slot, _KINDS[surface], key)
        self._places.arrange()
        return some_flat or not np.array_equal(before, self.visible.place)

    def known(self, doubts: NDArray[Any]) -> NDArray[np.bool_]:
        """Pixels whose hit is certain and told by its depth: two sheets may be nearer to each other than that tells."""
        known: NDArray[np.bool_] = (doubts["reasons"] & _DOUBT_HIT) == 0
        record = self.visible.record[doubts["winner"] >> 2]
        general = known & (record < 0)
        known[general] = (self.visible.general["flags"][~record[general]] & SHEETS) == 0
        return known

    def refine_seen(self, doubts: NDArray[Any]) -> bool:
        """Refines the general records that pixels with doubtful hits may see; whether there are any."""
        slots = self._seen_general(doubts)
        self.refine((~self.visible.record[slots]).astype(np.intp))
        return len(slots) > 0

    def _seen_general(self, doubts: NDArray[Any]) -> NDArray[np.intp]:
        """Slots with general records in the tiles of pixels with doubtful hits."""
        bins = self._bins
        doubtful = np.zeros(len(bins.end), dtype=np.bool_)
        hits = (doubts["reasons"] & _DOUBT_HIT) != 0
        doubtful[bins.tile_of(doubts["x"][hits], doubts["y"][hits])] = True
        seen = np.zeros(len(self.visible.record), dtype=np.bool_)
        seen[bins.entries[np.repeat(doubtful, np.diff(bins.end, prepend=0))]] = True
        return np.flatnonzero(seen & (self.visible.record < 0))

    def _tied(self, doubts: NDArray[Any]) -> list[tuple[int, int]]:
        """Slots and surfaces of the hits that tie."""
        tied = np.zeros(4 * len(self.visible.record), dtype=np.bool_)
        for side in ("winner", "rival"):
            tied[doubts[side][doubts["rival"] >= 0]] = True
        slot, kind = np.divmod(np.flatnonzero(tied), 4)
        return sorted(set(zip(slot.tolist(), _SURFACE_OF_KIND[kind].tolist(), strict=True)))

    def refine(self, rows: NDArray[np.intp]) -> None:
        """Rounds general records from exact forms."""
        quadric_of = self.visible.quadric[self.visible.record < 0]
        for row in rows[:_MOST_AT_ONCE].tolist():
            record, quadric = self.visible.general[row], int(quadric_of[row])
            # The kernels' forms are scaled to entries below 1, their directions by the unit.
            matrix_row = int(self._scene.quadrics.matrix_row[quadric])
            matrix = self._scene.quadrics.matrix[matrix_row] if matrix_row >= 0 else np.array([0.5])
            shrink = -int(np.frexp(np.abs(matrix).max())[1])
            with suppress(OverflowError):
                forms = self._exact.forms(quadric).about(*map(int, record["centre"]))
                _write_record(record, forms, shrink, self.visible.unit)

    def solve(self, planes: Planes, doubt: Any) -> None:
        """Writes one pixel of the planes."""
        x, y = int(doubt["x"]), int(doubt["y"])
        x0, y0 = self._scene.camera.crop[:2]
        if int(doubt["reasons"]) & _DOUBT_HIT:
            pixel = self._first_hit(x, y, float(doubt["depth"]))
        else:
            pixel = self._exact.pixel(x, y, [int(self.visible.quadric[int(doubt["winner"]) >> 2])])
        for channel in self._scene.output.channels:
            for name, value in self._exact.channel(channel, pixel).items():
                planes[name][y - y0, x - x0] = value
        if "A" in planes:
            planes["A"][y - y0, x - x0] = pixel is not None

    def _first_hit(self, x: int, y: int, depth: float) -> ExactPixel | None:
        """The pixel, looking behind the depth that casting found only where nothing is hit before it."""
        slots = self._bins.slots(int(self._bins.tile_of(x, y)))
        box = self.visible.box[slots]
        slots = slots[(box[:, 0] <= x) & (x < box[:, 2]) & (box[:, 1] <= y) & (y < box[:, 3])]
        depth *= 1 + 2.0**-20
        front = self.visible.nearest[slots] <= depth
        if not front.all() and depth > 0:
            pixel = self._exact.pixel(x, y, self.visible.quadric[slots[front]].tolist())
            if pixel is not None and pixel.z <= depth:
                return pixel
        return self._exact.pixel(x, y, self.visible.quadric[slots].tolist())


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
