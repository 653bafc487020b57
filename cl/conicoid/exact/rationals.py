"""Binary64 numbers as rationals, and integers in lowest terms."""

from collections.abc import Sequence

from flint import fmpq, fmpq_mat, fmpz

from conicoid.scene import Floats


def exact(value: float) -> fmpq:
    """The rational that a finite binary64 number is."""
    return fmpq(*value.as_integer_ratio())


def nearest(value: fmpq) -> float:
    """The nearest binary64: Python divides integers with correct rounding. OverflowError if there is none."""
    return int(value.p) / int(value.q)


def exact_matrix(values: Floats) -> fmpq_mat:
    """The rational matrix that a finite (m, n) array is."""
    rows, columns = values.shape
    return fmpq_mat(rows, columns, [exact(value) for value in values.ravel().tolist()])


def affine_matrix(upper: Floats) -> fmpq_mat:
    """The 4x4 matrix of an affine map whose upper rows are given, (3, 4)."""
    return fmpq_mat(4, 4, [*exact_matrix(upper).entries(), 0, 0, 0, 1])


def primitive(values: Sequence[fmpz]) -> tuple[fmpz, ...]:
    """The integers divided by their greatest common divisor; signs and zeros stay."""
    common = fmpz(0)
    for value in values:
        common = common.gcd(value)
        if common == 1:
            return tuple(values)
    return tuple(value // common for value in values) if common else tuple(values)


def sign(value: fmpz | fmpq) -> int:
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)
