"""Which quadrics a pixel need not ask, decided for all of them at once in binary64 with a rigorous error bound.

A quadric is skipped only where its S, and the f of each of its cap points, are on the missing side by more than a
relative 2^-10 of the terms about the pixel: neither the exact image nor the margins of `band` can then involve it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tests.oracle.exact_quadric import ExactQuadric
from tests.oracle.pixel_polynomial import Quadratic

ROBUST = 2.0**-10
# Each term: one rounding of the coefficient, at most two of the product (pixel coordinates are exact), five of the
# sum; the slopes have fewer terms. 16 halves of an ulp cover them all, second-order terms included.
ROUNDING = 16 * 2.0**-53


class Culling:
    """Conics of many quadrics as float arrays.

    Args:
        quadrics: all quadrics of a scene.
        half: half-width of a tile in doubled pixels, for the magnitude of the terms.
    """

    def __init__(self, quadrics: Sequence[ExactQuadric], half: int) -> None:
        self._half = half
        rows = [[quadric.s, *(_negated(disc) for disc in quadric.discs)] for quadric in quadrics]
        self._owner = np.array([k for k, row in enumerate(rows) for _ in row], dtype=np.intp)
        self._conics = np.array([_scaled(conic) for row in rows for conic in row], dtype=np.float64).reshape(-1, 6)

    def candidates(self, i: int, j: int) -> list[int]:
        """Indices, ascending, of the quadrics that may matter at doubled pixel coordinates (i, j)."""
        xx, xy, yy, x, y, one = self._conics.T
        terms = np.array([xx * i * i, xy * i * j, yy * j * j, x * i, y * j, one])
        value, error = terms.sum(axis=0), ROUNDING * np.abs(terms).sum(axis=0)
        slope = np.abs(2 * xx * i + xy * j + x) + np.abs(2 * yy * j + xy * i + y)
        curvature = np.abs(xx) + np.abs(xy) + np.abs(yy)
        spread = np.abs(value) + self._half * slope + self._half**2 * curvature
        # The slope's own rounding, seen over the tile, is at most half·2·error: i, j >= 1.
        spread_error = (2 * self._half + 2) * error + ROUNDING * spread
        missed = value + error < -ROBUST * (spread + spread_error)
        keep: NDArray[np.intp] = np.unique(self._owner[~missed])
        return [int(k) for k in keep]


def _negated(conic: Quadratic) -> Quadratic:
    return Quadratic(*(-term for term in conic))


def _scaled(conic: Quadratic) -> list[float]:
    """The coefficients divided by their largest, each correctly rounded; an all-zero conic stays zero."""
    terms = [int(term) for term in conic]
    largest = max(map(abs, terms)) or 1
    return [term / largest for term in terms]
