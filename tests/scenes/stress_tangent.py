"""Rays that touch, graze or start on a surface, exactly and by one unit in the last place."""

from tests.scenes.catalogue import Document
from tests.scenes.stress import CENTRED, UPRIGHT, ball, enter, form, orthographic, pinhole, stress, up

for steps, word in ((0, "exactly tangent"), (1, "2^-52 too large"), (-1, "2^-53 too small")):
    label = {0: "exact", 1: "above", -1: "below"}[steps]
    enter(f"tangent_ball_{label}", f"the outermost pixel centres are tangent: radius {word}",
          [ball(0, 0, -4, up(1.25, steps) if steps else 1.25)], orthographic(**CENTRED))  # fmt: skip
    enter(f"tangent_can_{label}", f"two columns touch the wall of a lying can: radius {word}",
          [{"shape": "cylinder", "center": [0, 0, -4], "rotation": [1, 0, 0, 1],
            "radius": up(1.25, steps) if steps else 1.25, "z_range": [-1, 1], "capped": True}],
          orthographic(**CENTRED))  # fmt: skip
    # The ray of slope 3/4 touches the ball of radius 3 about (0, 0, -5): 3-4-5.
    enter(f"tangent_ball_pinhole_{label}", f"the ray of slope 3/4 touches a ball by the 3-4-5 triangle: radius {word}",
          [ball(0, 0, -5, up(3.0, steps) if steps else 3)], pinhole(fx=4, fy=4, **CENTRED))  # fmt: skip


for steps in (0, 1, -1):
    label = {0: "on", 1: "above", -1: "below"}[steps]
    height = up(1.0, steps) if steps else 1.0
    enter(f"eye_{label}_a_ball", f"the eye lies {steps} units in the last place off a unit ball, looking along it",
          [ball(0, -height, 0, 1)], pinhole(cx=8.5, cy=4.5))  # fmt: skip
    enter(f"eye_{label}_a_wall", f"the eye lies {steps} units in the last place off the wall of a tube around it",
          [{"shape": "cylinder", "transform": [[0, 1, 0, 0], [1, 0, 0, -height], [0, 0, 1, 0], [0, 0, 0, 1]],
            "z_range": [-3, 1], "capped": True}], pinhole(**CENTRED))  # fmt: skip
    enter(f"eye_{label}_a_floor", f"the eye lies {steps} units in the last place off a plane through far offsets",
          [{"shape": "plane", "transform": [[1, 0, 0, 0], [0, 0, 1, -height], [0, -1, 0, 0], [0, 0, 0, 1]]}],
          pinhole(world_from_camera=[[1, 0, 0, 0], [0, 1, 0, -1], [0, 0, 1, 0], [0, 0, 0, 1]], **CENTRED))  # fmt: skip
    enter(f"eye_{label}_an_inclined_ball", "the same off a ball whose nearest point has long coordinates",
          [ball(0, up(-0.6, steps) if steps else -0.6, 0.8, 1)], pinhole())  # fmt: skip


@stress
def starts_on_a_ball() -> tuple[list[Document], Document]:
    """Orthographic rays start on the ball's equator, inside and outside of it: t > 0 decides."""
    return [ball(0, 0, 0, 1.25)], orthographic(**CENTRED)


@stress
def starts_on_a_slab() -> tuple[list[Document], Document]:
    """The camera's plane is one of two parallel planes: its hits have t = 0 and do not count."""
    return [{"shape": "parallel_planes", "center": [0, 0, -1]}], orthographic()


@stress
def starts_just_before_a_plane() -> tuple[list[Document], Document]:
    """A plane 5e-324 in front of the camera: the least positive t is a hit, at Z = 0."""
    return [{"shape": "plane", "center": [0, 0, -5e-324]}], orthographic()


@stress
def through_the_apex() -> tuple[list[Document], Document]:
    """The middle ray goes through the apex of a cone seen at an angle: S = 0 and no gradient."""
    rows = [[1, 0, 0, 0], [0, 0.8, -0.6, 0], [0, 0.6, 0.8, -4], [0, 0, 0, 1]]
    return [{"shape": "cone", "radius": 0.5, "transform": rows}], pinhole(**CENTRED)


@stress
def past_the_apex_by_a_unit() -> tuple[list[Document], Document]:
    """The apex lies one unit in the last place beside the middle ray, sideways."""
    rows = [[1, 0, 0, 2.0**-1060], [0, 0, -1, 0], [0, 1, 0, -4], [0, 0, 0, 1]]
    return [{"shape": "cone", "radius": 0.5, "transform": rows}], pinhole(**CENTRED)


@stress
def along_a_ruling() -> tuple[list[Document], Document]:
    """A cone touched along one of its rulings by the middle column: double roots at every t."""
    rows = [[1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 1, -4], [0, 0, 0, 1]]
    return [{"shape": "cone", "transform": rows}], orthographic(**CENTRED)


@stress
def through_the_line_of_a_pair() -> tuple[list[Document], Document]:
    """Crossed planes whose line runs through pixel centres at a slant."""
    rows = [[1, 0, 0.25, 0], [0, 0, 1, 0], [0, -1, 0, -4], [0, 0, 0, 1]]
    return [{"shape": "crossed_planes", "radii": [1, 0.5], "transform": rows}], orthographic(**CENTRED)


@stress
def grazing_a_pancake() -> tuple[list[Document], Document]:
    """A disc of 1 : 1e-9 seen from a slope of 1e-6: both roots nearly coincide, silhouettes are corners."""
    return [{"shape": "ellipsoid", "radii": [1.5, 1.5, 1e-9], "center": [0, 0, -4],
             "rotation": [-0.70710678, 0, 0, 0.7071075]}], pinhole(**CENTRED)  # fmt: skip


@stress
def grazing_a_plane() -> tuple[list[Document], Document]:
    """A floor seen at 1e-14 of a slope: depths of 1e13, in some rows behind the eye."""
    rows = [[1, 0, 0, 0], [0, 1e-14, 1, -0.125], [0, -1, 1e-14, 0], [0, 0, 0, 1]]
    return [{"shape": "plane", "transform": rows}], orthographic(**CENTRED)


@stress
def concentric_tangents() -> tuple[list[Document], Document]:
    """Five balls touched by the same ray in the same point, the largest first."""
    return [ball(0, 1.25 - r, -4, r, id=k + 1) for k, r in enumerate((1.25, 1.0, 0.75, 0.5, 0.25))], orthographic(
        **CENTRED
    )


@stress
def horizon_of_a_planet() -> tuple[list[Document], Document]:
    """A ball of 6.4e6 seen from 2 above it, and a ball of 1 on its horizon."""
    return [ball(0, -6.4e6 - 2, 0, 6.4e6), ball(0.3, -1.9, -3000, 1)], pinhole(fx=2000, fy=2000, cy=5)


@stress
def paraboloid_touched_from_inside() -> tuple[list[Document], Document]:
    """The eye in the focus of a mirror, rays through its vertex and along its axis."""
    return [{"shape": "paraboloid", "radius": 2, "center": [0, 0, -1]}], pinhole(**CENTRED)


@stress
def hyperboloid_asymptotes() -> tuple[list[Document], Document]:
    """Rays through the centre along the asymptotic cone: a = 0 and b = 0 with c = -1, no hit at all."""
    rows = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    return [{"shape": "hyperboloid_one_sheet", "transform": rows}], pinhole(fx=4, fy=4, **CENTRED)


@stress
def two_sheets_between() -> tuple[list[Document], Document]:
    """The eye between two sheets, rays just inside and outside of their asymptotic cone."""
    rows = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    return [{"shape": "hyperboloid_two_sheets", "transform": rows}], pinhole(fx=4, fy=4, **CENTRED)


@stress
def double_root_of_a_product() -> tuple[list[Document], Document]:
    """x² + 2xy + y² as coefficients: a double plane, whose S is 0 everywhere, tilted by 2^-30."""
    tilt = 2.0**-30
    return [form(1, 1, tilt, 0, 1, tilt, 0, tilt * tilt, 0, 0, transform=UPRIGHT)], pinhole(**CENTRED)


for thirds in (1, 2, 4, 5):
    enter(f"rims_of_{thirds}_thirds_before_a_wall",
          "columns of thirds, where binary64 has none: the rims of a ball and a can miss a column by 2^-54, or not",
          [ball(0, 0, -4, thirds / 3),
           {"shape": "cylinder", "radius": thirds / 3, "transform": UPRIGHT, "z_range": [-0.5, 0.5]},
           {"shape": "plane", "center": [0, 0, -9]}],
          orthographic(fx=3, fy=3, **CENTRED))  # fmt: skip
