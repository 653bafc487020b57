"""How far the kernels' polynomials are from exact, against the bounds that the kernels state."""

import argparse
import tempfile
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pytest
from flint import arb, fmpq, fmpz
from numpy.typing import NDArray

from conicoid.cast import _FILES as CAST_FILES
from conicoid.cast import _FRAME as FRAME
from conicoid.device import find_device
from conicoid.exact import ExactForms, ExactScene, RationalPolynomial
from conicoid.extent import Model, extent_of
from conicoid.memory import Queue
from conicoid.program import build
from conicoid.scene import Scene
from conicoid.setup import Setup, Visible
from conicoid.view import View, view_of
from tests.cl.kernel_sources import Edit, edit_kernels
from tests.cl.simple_reference import SimpleReference
from tests.scenes import as_scene
from tests.scenes.catalogue import PROJECTIONS, document
from tests.scenes.stress_mix import Mix
from tests.stress.workload import balls, far_and_tiny

LANES = 4
ROW = 16
GENERAL = ("S", "a", "b", "c", "range z0", "cap z0", "range z1", "cap z1")
SIMPLE = ("simple S", "simple b", "simple key", "simple gradient")


class BoundsProbe:
    """Evaluates records at pixels with the functions of casting, of kernels with `edits`.

    Attributes:
        evaluations: values compared so far.
        worst: by polynomial, the largest |computed - exact| / bound so far.
        beyond: values whose error is larger than their bound.
    """

    def __init__(self, folder: Path, edits: Sequence[Edit] = ()) -> None:
        self._queue = Queue(find_device())
        with pytest.MonkeyPatch.context() as patch:
            edit_kernels(folder, edits, patch)
            source = Path(__file__).with_suffix(".cl").read_text(encoding="utf-8")
            (folder / "kernels" / "bounds_probe.cl").write_text(source, encoding="utf-8")
            sources = [*(name for name in CAST_FILES if name.endswith(".h")), "bounds_probe.cl"]
            program = build(self._queue.context, sources, {"REAL_BITS": 64, "LANES": LANES, "EXACT": 1})
            self._setup = Setup(self._queue)
        self._general, self._simple = program.evaluate_general, program.evaluate_simple
        self.evaluations = self.beyond = 0
        self.worst: dict[str, float] = defaultdict(float)

    def check(self, scene: Scene, per_quadric: int, seed: int, *, general: bool) -> None:
        """Compares every visible quadric at that many of the pixels of its box, with records of one kind."""
        # The ends of ranges as they are: `exact` knows no others.
        model = Model(scene.quadrics, extent_of(scene.quadrics))
        view = view_of(scene.camera, scene.output)
        visible = self._setup.run(model, scene.camera, view, want_back=general)
        frame = _frame(view, visible)
        draw = np.random.default_rng(seed)
        exact = ExactScene(scene)
        for is_general in (False, True):
            slots = np.flatnonzero((visible.record < 0) == is_general)
            if not len(slots):
                continue
            repeated = np.repeat(slots, per_quadric)
            box = visible.box[repeated]
            pixels = draw.integers(box[:, :2], box[:, 2:]).astype(np.int32)
            records = ~visible.record[repeated] if is_general else repeated.astype(np.int32)
            values = self._evaluate(visible, pixels, records, frame, general=is_general)
            for k, slot in enumerate(slots):
                rows = slice(k * per_quadric, (k + 1) * per_quadric)
                forms = _references(exact, scene, visible, int(slot), general=is_general)
                self._compare(forms, pixels[rows], values[rows])
                if not is_general:
                    self._compare_hits(_simple_reference(forms, frame), pixels[rows], values[rows])

    def _evaluate(
        self,
        visible: Visible,
        pixels: NDArray[np.int32],
        rows: NDArray[np.int32],
        frame: NDArray[np.void],
        *,
        general: bool,
    ) -> NDArray[np.float64]:
        values = np.zeros((len(pixels), ROW))
        records = visible.general if general else visible.slots
        buffers = [self._queue.read_only(array) for array in (pixels, rows.astype(np.int32), records)]
        beside = self._queue.read_only(visible.clips if general else frame)
        kernel = self._general if general else self._simple
        self._queue.run_grid(kernel, (len(pixels), 1), *buffers, beside, self._queue.in_place(values))
        return values

    def _compare(
        self,
        forms: Iterable[tuple[str, RationalPolynomial, fmpq]],
        pixels: NDArray[np.int32],
        values: NDArray[np.float64],
    ) -> None:
        for k, (name, polynomial, factor) in enumerate(forms):
            # Quadratics of doubled coordinates are four times the function, linear forms twice.
            whole = polynomial.whole
            terms = (
                [fmpz(4), fmpz(4), fmpz(4), fmpz(2), fmpz(2), fmpz(1)]
                if len(whole) == 6
                else [fmpz(2), fmpz(2), fmpz(1)]
            )
            scale = terms[0]
            doubled = type(whole)(*(scale // weight * term for weight, term in zip(terms, whole, strict=True)))
            over = factor / (scale * polynomial.over)
            for (x, y), value, bound in zip(pixels.tolist(), values[:, 2 * k], values[:, 2 * k + 1], strict=True):
                if not np.isfinite(bound):
                    continue
                exact = doubled.at(fmpz(2 * x + 1), fmpz(2 * y + 1)) * over
                error = abs(_exact(value) - exact)
                ratio = error / _exact(bound) if bound else fmpq(2 if error else 0)
                self._count(name, int(ratio.p) / int(ratio.q), beyond=ratio > 1)

    def _compare_hits(self, reference: SimpleReference, pixels: NDArray[np.int32], values: NDArray[np.float64]) -> None:
        for (x, y), row in zip(pixels.tolist(), values, strict=True):
            if not np.isfinite(row[5]):
                continue
            key, gradient = reference.at(x, y)
            off = [(part - _exact(value)) ** 2 for part, value in zip(gradient, row[6:9], strict=True)]
            for name, error, bound in (
                ("simple key", abs(key - _exact(row[4])), row[5]),
                ("simple gradient", sum(off, arb(0)).sqrt(), row[9]),
            ):
                ratio = error / _exact(bound)
                self._count(name, float(ratio), beyond=not ratio < 1)

    def _count(self, name: str, ratio: float, *, beyond: bool) -> None:
        self.evaluations += 1
        self.beyond += beyond
        self.worst[name] = max(self.worst[name], ratio)


def sample(probe: BoundsProbe, seeds: Iterable[int], per_quadric: int) -> None:
    """Mixes of all shapes, small balls, far and tiny things."""
    for seed in seeds:
        quadrics, camera, sides = Mix(seed).scene(12, PROJECTIONS[seed % 2], 640, 480)
        probe.check(as_scene(document(quadrics, camera, **sides)), per_quadric, seed, general=True)
        crowd = as_scene(balls(seed, 40, 640, 480))
        for general in (False, True):
            probe.check(crowd, per_quadric, seed, general=general)
        tiny = as_scene(far_and_tiny(seed))
        probe.check(tiny, 8 * per_quadric, seed, general=True)
        probe.check(tiny, 8 * per_quadric, seed, general=False)


def _exact(value: float) -> fmpq:
    return fmpq(*float(value).as_integer_ratio())


def _frame(view: View, visible: Visible) -> NDArray[np.void]:
    """What a simple gradient takes of a frame, as casting sets it."""
    frame = np.zeros(1, dtype=FRAME)
    frame["axes"] = -view.image_rows @ view.target
    frame["axes"][0, 2] *= 1 / visible.unit if view.orthographic else 1
    frame["principal"], frame["orthographic"] = view.principal, view.orthographic
    return frame


def _simple_reference(
    forms: Sequence[tuple[str, RationalPolynomial, fmpq]], frame: NDArray[np.void]
) -> SimpleReference:
    (_, s, s_factor), (_, b, b_factor) = forms
    axes = [[_exact(value) for value in row] for row in frame["axes"][0].tolist()]
    cx, cy = (_exact(value) for value in frame["principal"][0].tolist())
    return SimpleReference(s, s_factor, b, b_factor, axes, None if frame["orthographic"][0] else (cx, cy))


def _references(
    exact: ExactScene, scene: Scene, visible: Visible, slot: int, *, general: bool
) -> list[tuple[str, RationalPolynomial, fmpq]]:
    """Name, exact polynomial and the record's scale, in the order of the probe's output."""
    quadric = int(visible.quadric[slot])
    forms = exact.forms(quadric)
    unit = fmpq(*float(visible.unit).as_integer_ratio())
    if not general:
        return _simple_references(forms, unit, orthographic=scene.camera.projection == "orthographic")
    row = scene.quadrics.matrix_row[quadric]
    shrink = fmpq(1)
    if row >= 0:
        shrink = fmpq(2) ** -int(np.frexp(np.abs(scene.quadrics.matrix[row]).max())[1])
    references = [("S", forms.s, (shrink * unit) ** 2), ("a", forms.a, shrink * unit**2), ("b", forms.b, shrink * unit),
                  ("c", forms.c, shrink)]  # fmt: skip
    for end, (offset, cap) in enumerate(zip(forms.range, forms.cap, strict=True)):
        references += [(GENERAL[4 + 2 * end], offset, fmpq(1)), (GENERAL[5 + 2 * end], cap, shrink * unit**2)]
    return references


def _simple_references(
    forms: ExactForms, unit: fmpq, *, orthographic: bool
) -> list[tuple[str, RationalPolynomial, fmpq]]:
    """1/t = -b/c + sqrt(S/c^2) for a pinhole, -t = b/a + sqrt(S/a^2) for parallel rays; t in units."""
    fixed = forms.a if orthographic else forms.c
    value = fmpq(fixed.whole.one, fixed.over)
    in_units = 1 / unit if orthographic else -unit
    return [("simple S", forms.s, (in_units / value) ** 2), ("simple b", forms.b, in_units / value)]


def main() -> None:
    parser = argparse.ArgumentParser(description="the worst |computed - exact| / bound of each quantity")
    parser.add_argument("seeds", type=int)
    with tempfile.TemporaryDirectory() as folder:
        probe = BoundsProbe(Path(folder))
        sample(probe, range(parser.parse_args().seeds), per_quadric=16)
    print(f"{probe.evaluations} evaluations, {probe.beyond} beyond their bounds")
    for name, ratio in probe.worst.items():
        print(f"{name:16} {ratio:.2f}")


if __name__ == "__main__":
    main()
