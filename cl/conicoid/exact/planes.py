"""Flat pieces of a quadric, its planes and its caps: what is asked of them is a question of lines across the image.

Along a ray a plane is e + g t, with one of e and g the same on every ray, so that t = -e/g, and whatever is asked of
another such function there has the sign of a linear function of the pixel.
"""

from collections.abc import Sequence
from typing import NamedTuple

from flint import fmpz, fmpz_mat

from conicoid.exact.polynomial import Linear
from conicoid.exact.rationals import primitive, sign


class SeenPlane(NamedTuple):
    """An affine function of the world along the rays, in pixel coordinates, times a positive number.

    Attributes:
        fixed: what is the same on every ray: its value at the eye, or its slope along parallel rays.
        moving: the other of offset and slope.
    """

    fixed: fmpz
    moving: Linear

    def crossed(self, other: "SeenPlane") -> Linear:
        """What vanishes where both planes meet one ray in one point."""
        pairs = zip(self.moving, other.moving, strict=True)
        return Linear(*[self.fixed * theirs - other.fixed * own for own, theirs in pairs])

    def keeps(self, plane: "SeenPlane") -> Linear:
        """Not negative where the half-space of this function >= 0 holds the point t > 0 of the plane.

        The function is there its `crossed` over the plane's slope, times -1 with parallel rays; that slope has the sign
        of -fixed (pinhole: t > 0) or fixed.
        """
        side = -sign(plane.fixed)
        return Linear(*[side * value for value in self.crossed(plane)])


class FlatPiece(NamedTuple):
    """A plane of a quadric, or one of its caps.

    Attributes:
        plane: its equation in the world, in a form that equal planes share.
        seen: the same along the rays.
        kept: it is kept by near, far, range and clips where all of these are not negative.
    """

    plane: tuple[fmpz, ...]
    seen: SeenPlane
    kept: list[Linear]


class FlatPieces(NamedTuple):
    """What of a quadric is flat.

    Attributes:
        sheets: the planes that the surface consists of, if it does, and caps at z0 and z1, if there are any; None for
            one that is never seen.
        turn: of two sheets e + g t and e' + g' t, k (e g' - e' g), where f is k times their product, k > 0 or < 0.
        faces: of two sheets, normals in target space towards the eye, not of unit length.
    """

    sheets: list[FlatPiece | None]
    caps: list[FlatPiece | None]
    turn: Linear | None
    faces: list[list[fmpz]]


def factors(form: fmpz_mat) -> tuple[int, list[list[fmpz]]]:
    """Planes (x, y, z and constant coefficients) whose product is a form, or one whose square is, and its sign.

    No planes where the form is no such product, or its planes are irrational. A plane at infinity, the second factor of
    a linear function, is left out.
    """
    rows = form.tolist()
    first = next((i for i in range(4) if rows[i][i]), None)
    if first is None:
        i, j = next((i, j) for i in range(4) for j in range(i) if rows[i][j])
        is_product = _is_sum(form, rows[i][j], [(rows[i], rows[j]), (rows[j], rows[i])])
        return sign(rows[i][j]), _finite([rows[i], rows[j]] if is_product else [])
    # form[i][i] f = p^2 + rest, and rest[j][j] rest = r^2.
    p, scale = rows[first], rows[first][first]
    rest = fmpz_mat([[scale * rows[i][j] - p[i] * p[j] for j in range(4)] for i in range(4)])
    second = next((j for j in range(4) if rest[j, j]), None)
    if second is None:
        return sign(scale), _finite([] if any(rest.entries()) else [p])
    r, square = rest.tolist()[second], -rest[second, second]
    root = square.isqrt() if square > 0 else fmpz(0)
    if root * root != square or not _is_sum(rest, -square, [(r, r)]):
        return 0, []
    planes = [[x + side * root * y for x, y in zip(r, p, strict=True)] for side in (-1, 1)]
    return -sign(scale), _finite(planes)


def plane_key(row: Sequence[fmpz]) -> tuple[fmpz, ...]:
    """Coefficients of an equation in a form that equal sets of points share."""
    leading = next(sign(term) for term in row if term)
    return tuple(leading * term for term in primitive(row))


def _finite(planes: list[list[fmpz]]) -> list[list[fmpz]]:
    return [plane for plane in planes if any(plane[:3])]


def _is_sum(form: fmpz_mat, factor: fmpz, products: list[tuple[list[fmpz], list[fmpz]]]) -> bool:
    """Whether factor times the form is the sum of the outer products."""
    return all(
        factor * form[i, j] == sum((p[i] * q[j] for p, q in products), fmpz(0)) for i in range(4) for j in range(i, 4)
    )
