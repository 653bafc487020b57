"""What exact arithmetic tells casting about surfaces as wholes: which are one, and where their flat pieces are.

Two surfaces that are the same set of points share a place. A plane, a sheet of a pair of planes, or a cap is kept by a
half-space on one side of a line across the image, and nearer than another plane on one side of another line: a line
that vanishes where they tie at every pixel, and whose coefficients are rounded once where they nearly do.
"""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from typing import Any, Final

import numpy as np
from flint import fmpz
from numpy.typing import NDArray

from conicoid.exact import ExactScene, FlatPiece, Linear, RationalPolynomial, SeenPlane
from conicoid.scene import Camera, Floats
from conicoid.setup import CLIP, PLANE, Visible

# `flags` and kinds of hits in kernels/records.h and candidates.h.
SHEETS: Final = 64
_CAP_LOW: Final = 2
_UNSEEN: Final = 16
_SMALLEST: Final = 2.0**-900
# Planes whose keys differ by less, at every corner of the image, are ordered by their differences.
_NEAR: Final = 2.0**-40


class Places:
    """The places of one frame's surfaces; `visible` is what casting is to know of them.

    Attributes:
        visible: the frame's records, `place`, `planes` and `clips` of which grow; `general` is written in place.
    """

    def __init__(self, visible: Visible, exact: ExactScene, camera: Camera) -> None:
        self.visible = visible
        self._exact, self._camera = exact, camera
        self._place_of: dict[tuple[fmpz, ...], int] = {}
        self._planes: dict[int, SeenPlane] = {}

    def name(self, slot: int, kinds: Iterable[int], key: tuple[fmpz, ...]) -> int:
        """Numbers the surface that hits of some kinds lie on; equal keys, equal places."""
        place = self._place_of.setdefault(key, len(self._place_of))
        self.visible.place[slot, list(kinds)] = place
        return place

    def add_flat(self, slots: Iterable[int]) -> bool:
        """Reduces the flat pieces of general records to lines; whether there are any."""
        clips, found = [self.visible.clips], False
        start = len(self.visible.clips)
        for slot in slots:
            record = self.visible.general[~self.visible.record[slot]]
            pieces = self._exact.flat_pieces(int(self.visible.quadric[slot]))
            kinds = [*enumerate(pieces.sheets), *enumerate(pieces.caps, _CAP_LOW)]
            found |= bool(kinds)
            for kind, piece in kinds:
                record["placed"] |= 1 << kind if piece else _UNSEEN << kind
                if piece:
                    self._planes[self.name(slot, [kind], piece.plane)] = piece.seen
                    clips.append(_lines(piece))
                    record["clip_start"][kind], record["clip_count"][kind] = start, len(piece.kept)
                    start += len(piece.kept)
            if pieces.turn:
                record["flags"] |= SHEETS
                record["sheet"] = _rounded(pieces.turn.about(*map(int, record["centre"])))
                record["face"] = [_rounded(face) for face in pieces.faces]
        self.visible = replace(self.visible, clips=np.concatenate(clips))
        return found

    def arrange(self) -> None:
        """Finds which planes nearly coincide on the image, and their differences."""
        planes = np.zeros(len(self._place_of), dtype=PLANE)
        planes["cluster"] = -1
        self.visible = replace(self.visible, planes=planes)
        places = [place for place, plane in self._planes.items() if np.isfinite(self._keys(plane)).all()]
        keys = np.array([self._keys(self._planes[place]) for place in places]).reshape(-1, 5)
        first: dict[int, SeenPlane] = {}
        for place, cluster in zip(places, _clusters(keys), strict=True):
            plane = self._planes[place]
            with suppress(OverflowError):
                lead = self._lead(plane, first.setdefault(cluster, plane))
                if ((lead == 0) | (np.abs(lead) > _SMALLEST)).all():
                    planes[place] = lead, cluster

    def _lead(self, plane: SeenPlane, other: SeenPlane) -> Floats:
        """(3,) float64: a plane's key less that of another; keys are 1 / t (pinhole) or -t, in the frame's unit."""
        orthographic = self._camera.projection == "orthographic"
        over = plane.fixed * other.fixed
        side = 1 if (over > 0) != orthographic else -1
        line = Linear(*[side * value for value in plane.crossed(other)])
        per_unit = int(np.log2(self.visible.unit))
        return RationalPolynomial(line, abs(over)).rounded(-per_unit if orthographic else per_unit)

    def _keys(self, plane: SeenPlane) -> list[float]:
        """Keys of a plane at the corners of the crop, up to a sign, and the size of their terms; infinite if beyond."""
        x0, y0, x1, y1 = self._camera.crop
        moving, fixed = plane.moving, int(plane.fixed)
        try:
            keys = [int(moving.at(fmpz(x), fmpz(y))) / fixed for x in (x0, x1) for y in (y0, y1)]
            return [*keys, int(abs(moving.u) * x1 + abs(moving.v) * y1 + abs(moving.one)) / abs(fixed)]
        except OverflowError:
            return [np.inf] * 5


def _lines(piece: FlatPiece) -> NDArray[Any]:
    """(k,) of CLIP: half-spaces that hold t whatever it is."""
    clips = np.zeros(len(piece.kept), dtype=CLIP)
    for clip, line in zip(clips, piece.kept, strict=True):
        clip["offset"] = _rounded(line)
    return clips


def _rounded(line: Iterable[fmpz]) -> Floats:
    """(3,) float64, a multiple with the largest in [1/2, 1], of a function or vector of which only the sign matters."""
    whole = Linear(*line)
    return RationalPolynomial(whole, fmpz(1)).rounded(-max(int(value).bit_length() for value in whole))


def _clusters(keys: Floats) -> list[int]:
    """Numbers n planes by keys at four corners and their size, (n, 5): the same for chains that nearly coincide."""
    cluster = np.zeros(len(keys), dtype=np.intp)
    for corner in range(4):
        order = np.lexsort((keys[:, corner], cluster))
        apart = np.diff(keys[order, corner]) > _NEAR * np.minimum(keys[order[1:], 4], keys[order[:-1], 4])
        cluster[order[1:]] = np.cumsum(apart | (np.diff(cluster[order]) != 0))
        cluster[order[:1]] = 0
    return cluster.tolist()
