"""A resolved scene as arrays: what the document means, with every default filled in.

These binary64 values are the exact input: the image is defined as the exact mathematical image of them.
World units are the user's own, right-handed; camera axes are OpenGL's (looks down -z, +y up).
"""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

Projection = Literal["pinhole", "orthographic"]
Precision = Literal["exact", "float64", "float32"]
NormalSpace = Literal["world", "camera"]
NormalSide = Literal["facing", "outward"]
Compression = Literal["zip", "none", "rle", "zips", "piz", "zstd"]
DataWindow = Literal["full", "tight"]
Channel = Literal["Z", "T", "ZBack", "N", "P", "id", "A"]

Floats = NDArray[np.float64]


MOST_EXPANDED: Final = 10_000  # quadrics of a set that its canonical form lists one by one

# The float planes of each channel. The kernels write them in this order, whatever order the document asks them in.
PLANES: Final = {
    "Z": ("Z",), "T": ("T",), "ZBack": ("ZBack",), "N": ("N.X", "N.Y", "N.Z"), "P": ("P.X", "P.Y", "P.Z"), "A": ("A",)
}  # fmt: skip


@dataclass(frozen=True)
class KeptSet:
    """Quadrics that stay one entry in the canonical form, because there are so many of them.

    Attributes:
        start, stop: the indexes of the quadrics, half-open; more than `MOST_EXPANDED`.
        name: one that all share, or one for each; None if none was given.
    """

    start: int
    stop: int
    name: str | list[str] | None = None


@dataclass(frozen=True)
class Quadrics:
    """n quadrics in document order, one array per property.

    Attributes:
        shape: (n,) uint8, codes of `shapes.SHAPES`.
        radii: (n, 3) float64 > 0, (a, b, c); 1 where the shape has no such radius. A sphere's are all equal;
            a `parabolic_cylinder`'s radius is a, a `parallel_planes`' is c.
        matrix_row: (n,) int32, row of `matrix` for shape `quadric`, -1 for the others.
        matrix: (m, 4, 4) float64, symmetric Q with f = x^T Q x.
        world_from_object: (n, 3, 4) float64, the upper rows of the affine transform.
        id: (n,) uint32.
        z_range: (n, 2) float64 object-space extent; (-inf, inf) where not given.
        capped: (n,) bool.
        clip: (k, 4) float64 world half-spaces [a, b, c, d], keeping ax + by + cz + d >= 0.
        clip_start: (n + 1,) int32; quadric i is clipped by rows clip_start[i]:clip_start[i + 1].
        name: the given names by quadric index, of quadrics outside `sets`.
        sets: in document order, apart from each other.
    """

    shape: NDArray[np.uint8]
    radii: Floats
    matrix_row: NDArray[np.int32]
    matrix: Floats
    world_from_object: Floats
    id: NDArray[np.uint32]
    z_range: Floats
    capped: NDArray[np.bool_]
    clip: Floats
    clip_start: NDArray[np.int32]
    name: dict[int, str]
    sets: tuple[KeptSet, ...] = ()

    def __len__(self) -> int:
        return len(self.shape)


@dataclass(frozen=True)
class Camera:
    """One view.

    Attributes:
        projection: `pinhole`: ray t * ((u - cx)/fx, -(v - cy)/fy, -1) from the origin; `orthographic`: from
            ((u - cx)/fx, -(v - cy)/fy, 0) along (0, 0, -1). So t is the planar depth.
        width, height: the whole image, pixels.
        fx, fy: pixels (pinhole) or pixels per world unit (orthographic).
        cx, cy: principal point, pixels; pixel (i, j) is sampled at (i + 0.5, j + 0.5).
        world_from_camera: (4, 4) float64, OpenGL axes; the rotation part is taken as it is, not re-normalised.
        near, far: kept range of t, closed; far is inf where not given.
        crop: (x0, y0, x1, y1), half-open pixel window that is rendered.
    """

    projection: Projection
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    world_from_camera: Floats
    near: float
    far: float
    crop: tuple[int, int, int, int]


@dataclass(frozen=True)
class Output:
    """What is written, and how; see contract section 1.4 for the meaning of each word."""

    channels: tuple[Channel, ...] = ("Z", "N")
    normal_space: NormalSpace = "world"
    normal_side: NormalSide = "facing"
    background_depth: float = float("inf")
    precision: Precision = "exact"
    compression: Compression = "zip"
    data_window: DataWindow = "full"
    half_normals: bool = False


@dataclass(frozen=True)
class Scene:
    """Quadrics seen by one camera."""

    quadrics: Quadrics
    camera: Camera
    output: Output
