"""Binary64 numbers as rationals, and rationals as integers."""

from collections.abc import Iterable

from flint import fmpq, fmpq_mat, fmpz

from conicoid.scene import Floats


def exact(value: float) -> fmpq:
    """The rational that a finite binary64 number is."""
    return fmpq(*value.as_integer_ratio())


def exact_matrix(values: Floats) -> fmpq_mat:
    """The rational matrix that a finite (m, n) array is."""
    rows, columns = values.shape
    return fmpq_mat(rows, columns, [exact(value) for value in values.ravel().tolist()])


def affine_matrix(upper: Floats) -> fmpq_mat:
    """The 4x4 matrix of an affine map whose upper rows are given, (3, 4)."""
    return fmpq_mat([*exact_matrix(upper).tolist(), [fmpq(0), fmpq(0), fmpq(0), fmpq(1)]])


def integers(values: Iterable[fmpq]) -> tuple[fmpz, ...]:
    """The values times the positive rational that makes them integers without a common factor; zeros stay zeros."""
    values = list(values)
    numerators, _ = fmpq_mat(1, len(values), values).numer_denom()
    whole = numerators.entries()
    common = fmpz(0)
    for number in whole:
        common = common.gcd(number)
        if common == 1:
            return tuple(whole)
    return tuple(number // common for number in whole) if common else tuple(whole)


def sign(value: fmpz | fmpq) -> int:
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)
