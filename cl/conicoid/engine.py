"""The engine's front: a resolved scene in, planes of pixels out."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from conicoid.scene import Scene


@dataclass(frozen=True)
class Frame:
    """One rendered view.

    Attributes:
        planes: EXR channel name (`Z`, `T`, `ZBack`, `N.X`, ..., `P.X`, ..., `id`, `A`) to a C-contiguous (h, w)
            float32 array, uint32 for `id`; row 0 is the top row of `window`.
        window: (x0, y0, x1, y1), half-open, the data window in pixels of the whole image.
        setup_ms: time spent per quadric: forms, bounds, bins.
        cast_ms: time spent per pixel.
    """

    planes: dict[str, NDArray[Any]]
    window: tuple[int, int, int, int]
    setup_ms: float
    cast_ms: float


class Renderer:
    """An OpenCL device with its kernels built; not thread-safe, use one per process."""

    def __init__(self, device: str | None = None) -> None:
        raise NotImplementedError

    def render(self, scene: Scene) -> Frame:
        raise NotImplementedError
