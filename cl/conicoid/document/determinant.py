"""The exact sign of 3x3 determinants: whether a matrix is invertible, without a tolerance.

A float filter decides nearly all; the doubtful rest goes to integers of any size, which binary64 entries are up to
a power of two.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Floats

# Each of the six products passes at most five roundings on its way into the sum, and so does its magnitude on its way
# into the permanent: |error| <= 5.01u * exact permanent <= 5.02u * computed permanent, u = 2^-53; 8u is on the safe
# side. Entries are below 1 after scaling, where every underflow loses at most 2^-1075 and there are fewer than 100.
_RELATIVE: Final = 8 * 2.0**-53
_ABSOLUTE: Final = 2.0**-1060


def determinant_sign(matrices: Floats) -> NDArray[np.int8]:
    """Sign of the exact determinant of each finite (n, 3, 3) matrix: (n,) int8 of -1, 0, 1."""
    largest = np.abs(matrices).max(axis=2, keepdims=True)
    rows = np.ldexp(matrices, -np.frexp(largest)[1])
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(rows, 0, 2)
    value = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    a, b, c, d, e, f, g, h, i = map(abs, (a, b, c, d, e, f, g, h, i))
    permanent = a * (e * i + f * h) + b * (d * i + f * g) + c * (d * h + e * g)
    sign: NDArray[np.int8] = np.sign(value).astype(np.int8)
    doubtful = np.abs(value) <= _RELATIVE * permanent + _ABSOLUTE
    sign[doubtful] = _exact_signs(matrices[doubtful])
    return sign


def _exact_signs(matrices: Floats) -> list[int]:
    mantissas, exponents = np.frexp(matrices)
    whole = np.ldexp(mantissas, 53).astype(np.int64)
    # Each row times the power of two that makes its entries integers; a zero's own exponent does not count.
    least = np.where(matrices == 0, np.iinfo(exponents.dtype).max, exponents).min(axis=2, keepdims=True)
    shifts = np.where(matrices == 0, 0, exponents - least)
    rows = zip(whole.reshape(-1, 9).tolist(), shifts.reshape(-1, 9).tolist(), strict=True)
    return [_sign([entry << shift for entry, shift in zip(*row, strict=True)]) for row in rows]


def _sign(entries: list[int]) -> int:
    a, b, c, d, e, f, g, h, i = entries
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return (determinant > 0) - (determinant < 0)
