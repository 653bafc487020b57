"""Far, tiny, huge and beside the range of numbers."""

from typing import Any

from tests.scenes.catalogue import Document
from tests.scenes.stress import ball, enter, form, orthographic, pinhole, posed, stress

CAN = {"shape": "cylinder", "rotation": [0.5, 0.2, 0.1, 1], "capped": True}


def pair(unit: float, **keys: Any) -> list[Document]:
    """A ball and a capped can at four units."""
    return [
        ball(-unit, 0.25 * unit, -4 * unit, unit, **keys),
        {**CAN, "center": [unit, 0, -4 * unit], "radius": 0.6 * unit, "z_range": [-unit, 0.75 * unit], **keys},
    ]


for exponent in (30, 100, 150, 300):
    for sign, word in ((1, "huge"), (-1, "tiny")):
        unit = float(f"1e{sign * exponent}")
        enter(f"units_1e{sign * exponent}_pinhole",
              f"lengths near 1e{sign * exponent}: squares leave binary64, depths may leave binary32",
              pair(unit), pinhole())  # fmt: skip
        enter(f"units_1e{sign * exponent}_orthographic",
              f"the same with pixels of {word} size", pair(unit), orthographic(fx=4 / unit, fy=4 / unit))  # fmt: skip
        enter(f"coefficients_1e{sign * exponent}",
              f"a surface does not change with the scale of its matrix: times 1e{sign * exponent}",
              [form(*(unit * x for x in (1.3, 0.2, 0, 0.1, 2, 0, 0, 0.9, 3.7, 13)))],
              pinhole())  # fmt: skip


for distance, radius in ((1e8, 1e-2), (1e10, 1e-3), (1e12, 1.0), (1e15, 0.5)):
    lens = 5 * distance / radius
    enter(f"ball_of_{radius:g}_at_{distance:g}",
          f"distance over radius {distance / radius:g}: S keeps none of its digits unless it is formed exactly",
          [ball(0.3 * radius, -0.2 * radius, -distance, radius)], pinhole(fx=lens, fy=lens))  # fmt: skip
    enter(f"can_of_{radius:g}_at_{distance:g}",
          f"walls and caps of a thing {distance / radius:g} times farther than it is large",
          [{**CAN, "center": [0.3 * radius, 0, -distance], "radius": radius, "z_range": [-radius, 1.1 * radius]}],
          pinhole(fx=lens, fy=lens))  # fmt: skip


for offset in (1e9, 1e12, 1e15):
    place = (offset, -offset, offset)
    near = [
        ball(place[0] - 1, place[1], place[2] - 4, 1),
        {**CAN, "center": [place[0] + 1, place[1], place[2] - 4], "radius": 0.75, "z_range": [-1, 1]},
        {"shape": "plane", "center": [place[0], place[1] - 1, place[2]], "rotation": [1, 0, 0, 1]},
    ]
    enter(f"everything_at_{offset:g}", "camera and scene share an offset that float64 can hardly resolve",
          near, pinhole(**posed(*place)))  # fmt: skip
    enter(f"everything_at_{offset:g}_orthographic", "the same with parallel rays and a clip through the place",
          [{**quadric, "clip": [[1, 0.5, 0, 0.3 - 0.5 * offset]]} for quadric in near],
          orthographic(**posed(*place)))  # fmt: skip


@stress
def subnormal_radius() -> tuple[list[Document], Document]:
    """A ball whose radius and place are subnormal."""
    return [ball(0, 1e-310, -4e-309, 1.2e-309)], pinhole()


@stress
def subnormal_coefficients() -> tuple[list[Document], Document]:
    """Coefficients of a few units of 2^-1074."""
    tiny = 5e-324
    return [form(tiny, 0, 0, 0, 2 * tiny, 0, 0, tiny, 4 * tiny, 14 * tiny)], pinhole()


@stress
def coefficients_of_all_sizes() -> tuple[list[Document], Document]:
    """One matrix with entries from 1e-300 to 1e300."""
    return [form(1e300, 0, 0, 1e-300, 1e-10, 0, 1e5, 1, 4, 15)], pinhole()


@stress
def depths_overflow_half_way() -> tuple[list[Document], Document]:
    """A ball whose nearer half has a float32 depth and whose farther half has not."""
    return [ball(0, 0, -3.4028235e38, 4e37)], pinhole(fx=60, fy=60)


@stress
def depths_at_the_last_float32() -> tuple[list[Document], Document]:
    """A slanted plane crosses the midpoint between the largest float32 and 2^128."""
    steps = 2.0**104
    return [{"shape": "plane", "transform": [[1, 0, 1e-8, 0], [0, 1, 0, 0], [-1e-8, 0, 1, -(2.0**128) + steps / 2],
                                             [0, 0, 0, 1]]}], orthographic(fx=4e-30, fy=4e-30)  # fmt: skip


@stress
def depths_are_subnormal_float32() -> tuple[list[Document], Document]:
    """Depths of 1e-42 keep few bits; those bits are still the nearest."""
    return pair(2.5e-43), pinhole()


@stress
def depths_round_to_zero() -> tuple[list[Document], Document]:
    """Depths of less than half of the smallest float32 are hits with Z = 0."""
    return pair(1e-46), orthographic(fx=4e46, fy=4e46)


@stress
def lens_of_1e30() -> tuple[list[Document], Document]:
    """Pixels of 1e-30 on a ball of 1e-30, 1 away."""
    return [ball(2e-31, 1e-31, -1, 1.1e-30)], pinhole(fx=5e30, fy=5e30)


@stress
def principal_point_far_outside() -> tuple[list[Document], Document]:
    """cx = -1e9: rays are almost parallel to the image, and the ball is where they go."""
    return [ball(4e9, 0.5, -4, 2)], pinhole(fx=1, fy=4, cx=-1e9, cy=6.3)


@stress
def tiny_before_huge() -> tuple[list[Document], Document]:
    """A ball of 1e-12 before one of 1e12, in one image."""
    return [ball(0, 0, -4e-12, 1e-12), ball(0, 0, -3e12, 1.2e12), ball(1.5e-6, 0, -4e-6, 1e-6)], pinhole()


@stress
def small_ball_beside_a_huge_wall() -> tuple[list[Document], Document]:
    """A wall that is a ball of radius 1e9 cuts a ball of 1."""
    return [ball(0, 0, -4 - 1e9, 1e9), ball(0.2, 0.1, -4, 1)], pinhole()
