"""Transforms that stretch, shear and flatten; needles and pancakes; depths on the midpoints of float32."""

from collections.abc import Sequence

from tests.scenes.catalogue import PROJECTIONS, Document
from tests.scenes.stress import CENTRED, ball, enter, form, orthographic, pinhole, posed, stress, up


def placed(shape: str, rows: Sequence[Sequence[float]], **keys: object) -> Document:
    return {"shape": shape, "transform": [*rows, [0, 0, 0, 1]], **keys}


for ratio in (1e6, 1e9, 1e12):
    thin = 1.5 / ratio
    enter(f"needle_1_to_{ratio:g}", f"an ellipsoid 1.5 long and {thin:g} thick along a column of pixel centres",
          [{"shape": "ellipsoid", "radii": [thin, 1.5, thin], "center": [0, 0, -4]}], pinhole(**CENTRED))  # fmt: skip
    enter(f"needle_1_to_{ratio:g}_along_the_view", f"the same, {thin:g} thick, pointing at the eye past a pixel",
          [{"shape": "ellipsoid", "radii": [thin, thin, 1.5], "center": [0.5 * thin, 0, -4]}],
          orthographic(**CENTRED))  # fmt: skip
    enter(f"pancake_1_to_{ratio:g}", "both roots are nearly one, everywhere",
          [{"shape": "ellipsoid", "radii": [1.5, 1.5, thin], "center": [0, 0, -4], "rotation": [0.4, 0.3, 0.2, 1]}],
          pinhole())  # fmt: skip
    enter(f"pancake_1_to_{ratio:g}_edge_on", "seen along its plane, by the rays of one row",
          [{"shape": "ellipsoid", "radii": [1.5, 1.5, thin], "center": [0, 0, -4], "rotation": [1, 0, 0, 1]}],
          orthographic(**CENTRED))  # fmt: skip
    enter(f"coin_1_to_{ratio:g}", "a capped can as thin as that: both caps and the rim",
          [{"shape": "cylinder", "radius": 1.5, "center": [0, 0, -4], "rotation": [0.6, 0.1, 0, 1],
            "z_range": [-thin, thin], "capped": True}], pinhole())  # fmt: skip
    enter(f"shear_{ratio:g}", f"a transform of condition {ratio:g}, undone by another shear of the radii",
          [placed("ellipsoid", [[1, ratio, 0, 0], [0, 1, 0, 0], [0, 0, 1, -4]], radii=[1, 1.5 / ratio, 1])],
          pinhole())  # fmt: skip
    enter(f"uneven_scales_{ratio:g}", "columns of a transform that radii undo",
          [placed("hyperboloid_one_sheet", [[ratio, 0, 0.1, 0.25], [0, 1 / ratio, 0, 0], [0, 0.2 / ratio, 1, -4]],
                  radii=[0.5 / ratio, 0.75 * ratio, 0.5], z_range=[-1, 0.75], capped=True)],
          orthographic())  # fmt: skip


for ratio in (1e4, 1e7, 1e10):
    for projection, camera in (("pinhole", pinhole), ("orthographic", orthographic)):
        enter(f"hair_1_to_{ratio:g}_before_a_wall_{projection}",
              "far thinner than a pixel and aslant: its conic drowns in rounding, and no lane may hit it",
              [{"shape": "ellipsoid", "radii": [0.9, 0.9 / ratio, 0.9 / ratio], "center": [0.01, 0.02, -4],
                "rotation": [0, 0, 0.3, 1]}, {"shape": "plane", "center": [0, 0, -9]}], camera())  # fmt: skip


@stress
def nearly_singular() -> tuple[list[Document], Document]:
    """A transform whose third column is the sum of the others but for 2^-40."""
    rows: list[list[float]] = [[1, 0.5, 1.5, 0], [0.25, 1, 1.25 + 2.0**-40, 0], [0.5, -0.25, 0.25, -4]]
    return [placed("ellipsoid", rows, radii=[1, 1, 0.5])], pinhole()


@stress
def singular_but_for_a_bit() -> tuple[list[Document], Document]:
    """The determinant is 2^-52 and the object is flat: all double-doubles cancel."""
    rows: list[list[float]] = [[1, 1, 0, 0], [1, up(1.0), 0, 0], [0, 0, 1, -4]]
    return [placed("cylinder", rows, z_range=[-0.5, 0.5], capped=True), ball(0.5, 0.3, -4.2, 0.6)], pinhole()


@stress
def transform_of_1e100() -> tuple[list[Document], Document]:
    """A transform of 1e100 and a radius of 1e-100."""
    rows: list[list[float]] = [[1e100, 0, 0, 0.2], [0, 1e100, 0, 0], [0, 0, 1e100, -4]]
    return [
        placed("sphere", rows, radius=1.2e-100),
        placed("cone", rows, radius=0.5, z_range=[-1e-100, 1e-100]),
    ], pinhole()


@stress
def mirror_and_shear() -> tuple[list[Document], Document]:
    """A negative determinant of 1e-9, outward sides and caps."""
    rows: list[list[float]] = [[-1, 0.25, 0.5, 0], [0.25, 1e-9, 1, 0], [0, 0, 1, -4]]
    return [placed("cylinder", rows, radii=[1, 1e9], z_range=[-0.75, 0.5], capped=True)], orthographic()


@stress
def pose_that_flattens() -> tuple[list[Document], Document]:
    """A pose orthogonal only to 1e-6, taken as it stands, at 1e6."""
    pose = [[1, 9e-7, 0, 1e6], [0, 1, -4e-7, -1e6], [0, 3e-7, 1, 1e6], [0, 0, 0, 1]]
    return [ball(1e6 + 0.1, -1e6, 1e6 - 4, 1.2)], pinhole(world_from_camera=pose)


# 1 + 2^-24 is the midpoint of 1 and the next float32, 2^-23 above; the tie goes to the even one, 1.
for label, depth in (
    ("even", 4 + 2.0**-22),
    ("odd", 4 + 3 * 2.0**-22),
    ("above", up(4 + 2.0**-22)),
    ("below", up(4 + 3 * 2.0**-22, -1)),
    ("binade", up(4.0, -1)),
    ("below_binade", 4 - 2.0**-23),
):
    enter(f"midpoint_{label}", f"every depth is {depth!r}: a midpoint of float32, or one unit off it",
          [{"shape": "plane", "center": [0, 0, -depth]}], orthographic())  # fmt: skip
    enter(f"midpoint_{label}_pinhole", f"planar depth {depth!r} at every pixel; distances are what they are",
          [{"shape": "plane", "center": [0, 0, -depth]}], pinhole(fx=4, fy=4, **CENTRED))  # fmt: skip


@stress
def midpoints_along_a_slope() -> tuple[list[Document], Document]:
    """A plane whose depth rises by half a float32 a column: every other pixel is a midpoint."""
    rise = 2.0**-22 * 4
    rows: list[list[float]] = [[1, 0, 0, 0], [0, 1, 0, 0], [-rise, 0, 1, -5]]
    return [placed("plane", rows)], orthographic(**CENTRED)


for label, depth in (("even", 4 + 2.0**-22), ("odd", 4 + 3 * 2.0**-22)):
    lean = 2.0**-56
    enter(f"leaning_on_a_midpoint_{label}",
          f"depths {depth!r} but for 2^-56 of a slope: a tie in binary64, in truth above it or below",
          [placed("plane", [[1, 0, 0, 0], [0, 1, 0, 0], [lean, 0, 1, -depth]])], orthographic(**CENTRED))  # fmt: skip
    enter(f"leaning_on_near_{label}", "the same plane cut by near at that depth: one half of it is kept",
          [placed("plane", [[1, 0, 0, 0], [0, 1, 0, 0], [lean, 0, 1, -depth]])],
          orthographic(near=depth, **CENTRED))  # fmt: skip


@stress
def midpoints_of_a_parabola() -> tuple[list[Document], Document]:
    """Depths 4 + (x² + y²) 2^-22: squares of whole numbers of midpoints, rational roots of a linear equation."""
    return [form(2.0**-18, 0, 0, 0, 2.0**-18, 0, 0, 0, 0.5, 4)], orthographic(**CENTRED)


@stress
def midpoints_of_balls() -> tuple[list[Document], Document]:
    """Balls whose poles lie on midpoints and beside them: √S is rational in the middle ray alone."""
    return [ball(x * 0.5, 0, -4 - 2.0**-22, 0.25 - (k - 1) * 2.0**-54) for k, x in enumerate((-2, 0, 2))], orthographic(
        **CENTRED
    )


for name, nudge in (("", 0.0), ("_above", 2.0**-49), ("_below", -(2.0**-49)), ("_a_hair_above", 2.0**-54)):
    enter(f"normals_on_midpoints{name}",
          f"columns a sixteenth apart: a unit ball's normal lies half a step of 2^-23, and {nudge}, from a multiple",
          [ball(0, 0, -4, 1)], orthographic(fx=16, fy=10, cx=7.5 - 2.0**-20 - 16 * nudge))  # fmt: skip


@stress
def positions_on_midpoints() -> tuple[list[Document], Document]:
    """Heights near 100 have units of 2^-17: the columns' x, thirds of 6 + 3·2^-18, are odd halves of it."""
    return [{"shape": "plane", "center": [0, 0, -6 - 3 * 2.0**-18]}], pinhole(fx=3, fy=3, **posed(0, 100, 0), **CENTRED)


@stress
def distance_on_a_midpoint() -> tuple[list[Document], Document]:
    """t·|d| is a rational midpoint at the pixels of 3-4-5 and 8-15-17 slopes."""
    depth = 4 + 2.0**-20
    return [{"shape": "plane", "center": [0, 0, -depth]}], pinhole(fx=4, fy=4, **CENTRED)


@stress
def subnormal_midpoints() -> tuple[list[Document], Document]:
    """Depths of odd multiples of 2^-150: ties among the subnormal float32."""
    rows: list[list[float]] = [[1, 0, 0, 0], [0, 1, 0, 0], [-(2.0**-148), 0, 1, -(2.0**-144) - 2.0**-150]]
    return [placed("plane", rows)], orthographic(**CENTRED)


for projection in PROJECTIONS:
    scale = 2.0**-200
    enter(f"scaled_by_a_tiny_power_{projection}", "2^-200 of a plain scene: nothing but exponents changes",
          [ball(-scale, 0, -4 * scale, scale), placed("paraboloid", [[scale, 0, 0, scale], [0, 0, -scale, 0],
                                                                      [0, scale, 0, -4 * scale]], z_range=[0, 1])],
          pinhole() if projection == "pinhole" else orthographic(fx=4 / scale, fy=4 / scale))  # fmt: skip
