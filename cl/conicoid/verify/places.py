"""Which pixels to check: everywhere a little, and above all along silhouettes, where decisions are close."""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Planes = Mapping[str, NDArray[Any]]

# Neighbouring depths further apart than this, relative to the nearer, are two surfaces or a fold.
_JUMP: Final = 2.0**-6


def every_place(shape: tuple[int, int]) -> NDArray[np.intp]:
    """(h * w, 2) row and column of every pixel, row by row."""
    return np.argwhere(np.ones(shape, dtype=np.bool_))


def sampled_places(planes: Planes, count: int, seed: int = 0) -> NDArray[np.intp]:
    """(m, 2) rows and columns, m <= count, row by row: half on silhouettes, where there are so many, the rest random.

    The choice depends on the planes, the count and the seed only. All pixels where the image has no more than `count`.
    """
    shape = next(iter(planes.values())).shape
    if shape[0] * shape[1] <= count:
        return every_place(shape)
    rng = np.random.default_rng(seed)
    edge = silhouettes(planes).ravel()
    chosen = rng.permutation(np.flatnonzero(edge))[: count // 2]
    rest = np.ones(edge.shape, dtype=np.bool_)
    rest[chosen] = False
    others = rng.choice(np.flatnonzero(rest), count - len(chosen), replace=False)
    places = np.sort(np.concatenate([chosen, others]))
    return np.stack(np.divmod(places, shape[1]), axis=1)


def silhouettes(planes: Planes) -> NDArray[np.bool_]:
    """(h, w) pixels with a horizontal or vertical neighbour of another id or mask, or beyond a jump of the depth."""
    shape = next(iter(planes.values())).shape
    edge = np.zeros(shape, dtype=np.bool_)
    for name, plane in planes.items():
        if name not in ("A", "id", "Z"):
            continue
        for side, other in (((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
                            ((slice(None), slice(1, None)), (slice(None), slice(None, -1)))):  # fmt: skip
            apart = _jumps(plane[side], plane[other]) if name == "Z" else plane[side] != plane[other]
            edge[side] |= apart
            edge[other] |= apart
    return edge


def _jumps(first: NDArray[np.float32], second: NDArray[np.float32]) -> NDArray[np.bool_]:
    near, far = np.minimum(first, second), np.maximum(first, second)
    return np.asarray((far != near) & (far * (1 - _JUMP) > near))
