"""Quadrics by their matrix: between kinds by the last bit, of every rank and inertia, with offsets baked in."""

import itertools

from tests.scenes.catalogue import PROJECTIONS, Document
from tests.scenes.stress import CENTRED, enter, form, orthographic, pinhole, stress, up

TINY = 2.0**-52

NEARLY: dict[str, tuple[str, tuple[float, ...]]] = {
    "near_parabolic": ("an ellipsoid 2^26 long: the square of z is 2^-52 of the others",
                       (1, 0, 0, 0, 1, 0, 0, TINY, 0.5, 1.5)),
    "near_parabolic_saddle": ("the same with the other sign: it opens", (1, 0, 0, 0, 1, 0, 0, -TINY, 0.5, 1.5)),
    "near_cone": ("one sheet by 2^-52: the waist is 2^-26", (1, 0, 0, 0, -1, 0, 0, 1, 4, 16 - 2.0**-48)),
    "near_cone_two_sheets": ("two sheets by 2^-52", (1, 0, 0, 0, -1, 0, 0, 1, 4, 16 + 2.0**-48)),
    "near_double_plane": ("(x + y + z/3 + 1)² with every coefficient rounded: no square any more",
                          (1, 1, 1 / 3, 1, 1, 1 / 3, 1, 1 / 9, 1 / 3, 1)),
    "near_double_plane_apart": ("two planes 2^-25 apart", (0, 0, 0, 0, 0, 0, 0, 1, 4, 16 - 2.0**-52 * 16)),
    "near_double_plane_empty": ("z² + 2^-48 = 0 has no points", (0, 0, 0, 0, 0, 0, 0, 1, 4, 16 + 2.0**-48)),
    "near_plane_pair": ("crossed planes but for the last bit of one coefficient", (1, 0, 0, 0, -4, 0, 0, 0, 0, TINY)),
    "near_point": ("a ball of radius 2^-25 beside no pixel centre, at one", (1, 0, 0, 0, 1, 0, 0, 1, 4, 16 - 2.0**-50)),
    "near_line": ("a cylinder of radius 2^-26", (1, 0, 0, 0, 0, 0, 0, 1, 4, 16 - 2.0**-52 * 8)),
    "near_plane": ("a plane bent by 1e-300", (1e-300, 0, 0, 0, 0.5e-300, 0, 0.25, 0, 1, 3)),
    "cancelling_constant": ("J rounds away from the perfect square: (x + 0.1)² + (y + 0.2)² + (z + 4.3)² = 1 expanded",
                            (1, 0, 0, 0.1, 1, 0, 0.2, 1, 4.3, 0.01 + 0.04 + 18.49 - 1)),
}  # fmt: skip

for name, (reason, ten) in NEARLY.items():
    enter(name + "_pinhole", reason, [form(*ten)], pinhole(**CENTRED))
    enter(name + "_orthographic", reason, [form(*ten)], orthographic(**CENTRED))

# diag(signs) under a unimodular, dyadic congruence: every rank and inertia, none along an axis.
MIXING = ((1, 0.5, -0.25, 0.5), (0.25, 1, 0.5, -0.5), (-0.5, 0.25, 1, 4), (0.125, -0.125, 0.0625, 0.75))


def mixed(signs: tuple[int, ...]) -> list[list[float]]:
    """MIXINGᵀ diag(signs) MIXING, exactly: all products are dyadic and short."""
    return [
        [float(sum(sign * row[i] * row[j] for sign, row in zip(signs, MIXING, strict=True))) for j in range(4)]
        for i in range(4)
    ]


for plus, minus in itertools.product(range(5), range(5)):
    if plus + minus == 0 or plus + minus > 4 or plus < minus:
        continue
    signs = (1,) * plus + (-1,) * minus + (0,) * (4 - plus - minus)
    enter(f"inertia_{plus}_{minus}",
          f"a form of rank {plus + minus}: {plus} positive and {minus} negative squares, along no axis",
          [{"shape": "quadric", "matrix": mixed(signs)}],
          pinhole(**CENTRED) if (plus + minus) % 2 else orthographic(**CENTRED))  # fmt: skip
    turned = tuple(reversed(signs))
    enter(f"inertia_{plus}_{minus}_reversed_sign", "the negative of a form of that inertia: outside is inside",
          [{"shape": "quadric", "matrix": [[-x for x in row] for row in mixed(turned)]}],
          orthographic(**CENTRED) if (plus + minus) % 2 else pinhole(**CENTRED), normal_side="outward")  # fmt: skip


def shifted_ball(x: float, y: float, z: float, radius: float) -> Document:
    """A ball by its coefficients in the world: J is large, and rounded."""
    return form(1, 0, 0, -x, 1, 0, -y, 1, -z, x * x + y * y + z * z - radius * radius)


for offset in (1e3, 1e6, 1e7):
    enter(f"offset_{offset:g}_in_the_matrix",
          f"a ball about {offset:g} on every axis, baked into J: the rounded matrix is the input, and is rendered",
          [shifted_ball(offset, offset, -offset, max(1.0, offset * offset * 2e-15))],
          pinhole(world_from_camera=[[1, 0, 0, offset], [0, 1, 0, offset], [0, 0, 1, 4 - offset], [0, 0, 0, 1]]),
          )  # fmt: skip


@stress
def offset_beyond_binary64_in_the_matrix() -> tuple[list[Document], Document]:
    """A ball of 1 at 1e9 whose J has lost its radius: what is left of the rounded matrix is rendered."""
    return [shifted_ball(1e9, 0, -4, 1)], pinhole(
        world_from_camera=[[1, 0, 0, 1e9], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    )


@stress
def one_matrix_in_three_bits() -> tuple[list[Document], Document]:
    """Three balls by matrices that differ in the last bit of one coefficient: who is in front changes by pixel."""
    quadrics = [form(a, 0, 0, 0, 1, 0, 0, 1, 4, j, id=k + 5) for k, (a, j) in
                enumerate(((1, 15), (up(1.0), 15), (1, up(15.0, -1))))]  # fmt: skip
    return quadrics, orthographic(**CENTRED)


@stress
def definite_but_for_rounding() -> tuple[list[Document], Document]:
    """A form whose smallest eigenvalue is 2^-52 of the largest, along (1, 1, 1)."""
    third = -0.5 + TINY
    return [form(1, third, third, 0, 1, third, 0, 1, 4, 15)], pinhole(**CENTRED)


for projection in PROJECTIONS:
    enter(f"general_position_{projection}", "all ten coefficients, no symmetry",
          [form(0.5, 0.25, 0, 0.125, 0, 0.5, -0.25, 0, 1, 2),
           form(0.7, -0.3, 0.2, 0.6, 1.1, 0.4, -0.35, -0.45, -1.3, -2.9)],
          pinhole() if projection == "pinhole" else orthographic())  # fmt: skip


@stress
def b_vanishes_between_two_roots() -> tuple[list[Document], Document]:
    """At one pixel b is exactly 0 and computed as less or more: which root is called which hangs by that sign."""
    matrix = [[0.9375, 0.25, -0.375, 0.625], [0.25, -0.75, -0.625, 0.75], [-0.375, -0.625, -0.1875, 0.125],
              [0.625, 0.75, 0.125, 0]]  # fmt: skip
    camera = orthographic(width=48, height=36, fx=12, fy=12, cx=25.5, cy=19.5, crop=[6, 4, 22, 16])
    return [{"shape": "quadric", "matrix": matrix}], camera
