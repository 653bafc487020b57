"""The quadric shapes: names, codes, parameters and forms in parameter space.

In parameter space (object space divided by the radii) every shape but `quadric` is one fixed symmetric
4x4 form with entries 0, 1, -1 and 1/2: f(x) = X^T D X with X = (x/a, y/b, z/c, 1).
"""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Shape:
    """One shape of the scene document.

    Attributes:
        name: the document's word.
        code: small integer in arrays and kernels.
        radii: how many radii its `radii` list has; 0 where the shape takes none.
        radius: whether `radius` is accepted (it stands for all the radii at once).
        squares: coefficients of (x/a)^2, (y/b)^2, (z/c)^2.
        linear_z: coefficient of z (never divided by a radius).
        constant: constant term.
    """

    name: str
    code: int
    radii: int
    radius: bool
    squares: tuple[int, int, int]
    linear_z: int
    constant: int


SHAPES: Final = tuple(
    Shape(name, code, *row)
    for code, (name, row) in enumerate(
        {
            "sphere": (1, True, (1, 1, 1), 0, -1),
            "ellipsoid": (3, False, (1, 1, 1), 0, -1),
            "cylinder": (2, True, (1, 1, 0), 0, -1),
            "cone": (2, True, (1, 1, -1), 0, 0),
            "paraboloid": (2, True, (1, 1, 0), -1, 0),
            "hyperbolic_paraboloid": (2, False, (1, -1, 0), -1, 0),
            "hyperboloid_one_sheet": (3, False, (1, 1, -1), 0, -1),
            "hyperboloid_two_sheets": (3, False, (1, 1, -1), 0, 1),
            "parabolic_cylinder": (1, True, (1, 0, 0), -1, 0),
            "hyperbolic_cylinder": (2, False, (1, -1, 0), 0, -1),
            "plane": (0, False, (0, 0, 0), 1, 0),
            "parallel_planes": (1, True, (0, 0, 1), 0, -1),
            "crossed_planes": (2, False, (1, -1, 0), 0, 0),
            "quadric": (0, False, (0, 0, 0), 0, 0),
        }.items()
    )
)
