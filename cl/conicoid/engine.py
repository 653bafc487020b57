"""The engine's front: a resolved scene in, planes of pixels out."""

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyopencl
from numpy.typing import NDArray

from conicoid.bins import TILE, Binning
from conicoid.cast import Caster
from conicoid.data_window import tight_window
from conicoid.device import describe, find_device
from conicoid.extent import Model, model_of
from conicoid.memory import Queue
from conicoid.probe import check_arithmetic
from conicoid.refine import Refinement
from conicoid.scene import Camera, Output, Precision, Quadrics, Scene
from conicoid.settle import settle
from conicoid.setup import Setup, Visible
from conicoid.view import view_of


@dataclass(frozen=True)
class Frame:
    """One rendered view.

    Attributes:
        planes: EXR channel name (`Z`, `T`, `ZBack`, `N.X`, ..., `P.X`, ..., `id`, `A`) to a C-contiguous (h, w)
            float32 array, uint32 for `id`; row 0 is the top row of `window`. They share the renderer's memory and
            last until its next render.
        window: (x0, y0, x1, y1), half-open, the data window in pixels of the whole image.
        setup_ms: time spent per quadric: bounds, records, bins.
        cast_ms: time spent per pixel.
        refined, settled: pixels that binary64 could not certify, and double-double rounded, or exact arithmetic decided
            (`exact` only).
    """

    planes: dict[str, NDArray[Any]]
    window: tuple[int, int, int, int]
    setup_ms: float
    cast_ms: float
    refined: int = 0
    settled: int = 0


class Renderer:
    """An OpenCL device with its kernels built; not thread-safe, use one per process.

    Args:
        device: part of "platform name version device"; None reads `CONICOID_DEVICE`.
    Raises:
        DeviceError: there is no such device, or its arithmetic is not to be trusted.
        KernelError: a kernel did not build.
    """

    def __init__(self, device: str | None = None) -> None:
        queue = Queue(find_device(device))
        check_arithmetic(queue)
        self.device = describe(queue.device)
        self._setup, self._binning, self._caster = Setup(queue), Binning(queue), Caster(queue)
        self._refinement = Refinement(queue)
        # Of the last frame: the next often shows the same quadrics from elsewhere.
        self._given: Quadrics | None = None
        self._model: Model
        # PoCL compiles a kernel for its launch shape at the first launch: not at the user's.
        for precision in ("exact", "float64", "float32"):
            self.render(_warm_up_scene(precision))

    def render(self, scene: Scene) -> Frame:
        """Cast every pixel of the crop.

        Raises:
            MemoryError: NumPy or the driver gets no more memory.
        """
        try:
            return self._render(scene)
        except pyopencl.MemoryError as error:
            raise MemoryError(str(error)) from error

    def _render(self, scene: Scene) -> Frame:
        if scene.quadrics is not self._given:
            self._given, self._model = scene.quadrics, model_of(scene.quadrics)
        frame = self._full(replace(scene, quadrics=self._model.quadrics))
        planes, window = frame.planes, frame.window
        if scene.output.data_window == "tight":
            planes, window = _tighten(planes, window)
        planes = {name: plane for name, plane in planes.items() if name.split(".")[0] in scene.output.channels}
        return replace(frame, planes=planes, window=window)

    def _full(self, scene: Scene) -> Frame:
        """Every pixel of the crop, whatever the data window; in bands where lists would take too much memory."""
        start = time.perf_counter()
        view = view_of(scene.camera, scene.output)
        visible = self._setup.run(self._model, scene.camera, view, want_back="ZBack" in scene.output.channels)
        x0, y0, x1, y1 = scene.camera.crop
        middle = -(-(y0 + y1) // (2 * TILE)) * TILE
        if y0 < middle < y1 and not self._binning.fits(visible.box, scene.camera.crop):
            upper = self._band(scene, (x0, y0, x1, middle))
            return _stacked(upper, self._band(scene, (x0, middle, x1, y1)))
        bins = self._binning.run(visible.box, scene.camera.crop)
        cast_start = time.perf_counter()

        def cast(visible: Visible) -> tuple[dict[str, NDArray[Any]], NDArray[Any]]:
            return self._caster.run(scene, view, visible, bins)

        def refine(planes: dict[str, NDArray[Any]], doubts: NDArray[Any]) -> NDArray[np.bool_]:
            return self._refinement.run(scene, view, visible, planes, doubts)

        planes, refined, settled = settle(scene, visible, bins, cast, refine)
        end = time.perf_counter()
        times = 1e3 * (cast_start - start), 1e3 * (end - cast_start)
        return Frame(planes, scene.camera.crop, *times, refined, settled)

    def _band(self, scene: Scene, crop: tuple[int, int, int, int]) -> Frame:
        """Part of the crop, in memory of its own."""
        frame = self._full(replace(scene, camera=replace(scene.camera, crop=crop)))
        return replace(frame, planes={name: plane.copy() for name, plane in frame.planes.items()})


def _warm_up_scene(precision: Precision) -> Scene:
    """A sphere twice, once clipped, whose normals lie half a step from the next: launches every kernel once."""
    quadrics = Quadrics(
        shape=np.zeros(2, dtype=np.uint8), radii=np.ones((2, 3)), matrix_row=np.full(2, -1, dtype=np.int32),
        matrix=np.empty((0, 4, 4)), world_from_object=np.tile(np.eye(3, 4), (2, 1, 1)),
        id=np.ones(2, dtype=np.uint32), z_range=np.tile([-np.inf, np.inf], (2, 1)), capped=np.zeros(2, dtype=np.bool_),
        clip=np.array([[0.0, 0.0, 1.0, 0.0]]), clip_start=np.array([0, 0, 1], dtype=np.int32), name={},
    )  # fmt: skip
    pose = np.eye(4)
    pose[2, 3] = 4
    camera = Camera("orthographic", 64, 64, 32.0, 32.0, 31.5 - 2.0**-19, 32.0, pose, 0.0, np.inf, (0, 0, 64, 64))
    return Scene(quadrics, camera, Output(channels=("Z", "N"), precision=precision))


def _stacked(upper: Frame, lower: Frame) -> Frame:
    """Two frames, one below the other."""
    return Frame(
        {name: np.concatenate([plane, lower.planes[name]]) for name, plane in upper.planes.items()},
        (*upper.window[:3], lower.window[3]),
        upper.setup_ms + lower.setup_ms,
        upper.cast_ms + lower.cast_ms,
        upper.refined + lower.refined,
        upper.settled + lower.settled,
    )


def _tighten(
    planes: dict[str, NDArray[Any]], window: tuple[int, int, int, int]
) -> tuple[dict[str, NDArray[Any]], tuple[int, int, int, int]]:
    """The part of the planes that the hits take, and its window."""
    x0, y0 = window[:2]
    rows, columns = np.any(planes["A"], axis=1), np.any(planes["A"], axis=0)
    left, top, right, bottom = tight = tight_window(window, rows, columns)
    part = slice(top - y0, bottom - y0), slice(left - x0, right - x0)
    return {name: np.ascontiguousarray(plane[part]) for name, plane in planes.items()}, tight
