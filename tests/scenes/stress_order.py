"""Surfaces that coincide, nearly coincide, and crowds of all shapes."""

from tests.scenes.catalogue import PROJECTIONS, Document
from tests.scenes.stress import CENTRED, ball, enter, form, orthographic, pinhole, stress, up

ROUND = {"center": [0.1, -0.05, -4], "rotation": [0.3, 0.2, 0.1, 0.9]}

for projection, camera in zip(PROJECTIONS, (pinhole(), orthographic()), strict=True):
    enter(f"balls_a_unit_apart_{projection}", "three balls whose radii and places differ by one unit in the last place",
          [ball(0, 0, -4, 1.5), ball(0, 0, -4, up(1.5)), ball(up(0.0), 0, up(-4.0), 1.5)], camera)  # fmt: skip
    enter(f"planes_a_unit_apart_{projection}", "the nearer of two planes by one unit comes second",
          [{"shape": "plane", "center": [0, 0, -4]}, {"shape": "plane", "center": [0, 0, up(-4.0)]},
           {"shape": "plane", "center": [0, 0, up(-4.0, -1)]}], camera)  # fmt: skip
    enter(f"planes_crossing_at_a_unit_{projection}", "two planes 2^-52 of a slope apart cross in the middle column",
          [{"shape": "plane", "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0.25, 0, 1, -4], [0, 0, 0, 1]]},
           {"shape": "plane", "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [up(0.25), 0, 1, -4], [0, 0, 0, 1]]}],
          {**camera, **CENTRED})  # fmt: skip
    enter(f"coincident_wholes_{projection}", "four writings of one ellipsoid: the first of them wins",
          [{"shape": "ellipsoid", "radii": [1.5, 1, 0.75], "id": 9, **ROUND},
           {"shape": "ellipsoid", "radii": [1.5, 1, 0.75], "id": 2, **ROUND},
           {"shape": "sphere", "id": 4, "transform": [[1.5, 0, 0, 0], [0, 1, 0, 0.5], [0, 0, 0.75, -4], [0, 0, 0, 1]]},
           {"shape": "ellipsoid", "radii": [1.5, 1, 0.75], "id": 1, "center": [0, 0.5, -4]}], camera)  # fmt: skip
    enter(f"coincident_parts_{projection}", "one cone in four pieces that share rims, caps and clips",
          [{"shape": "cone", "id": 4, **ROUND, "z_range": [-1, -0.25], "capped": True},
           {"shape": "cone", "id": 3, **ROUND, "z_range": [-0.25, 0], "capped": True},
           {"shape": "cone", "id": 2, **ROUND, "z_range": [-0.25, 1], "clip": [[1, 0, 0, 0]]},
           {"shape": "cone", "id": 1, **ROUND, "z_range": [-0.25, 1], "clip": [[-1, 0, 0, 0]]}], camera)  # fmt: skip
    enter(f"plane_on_faces_{projection}", "a plane, a face of a slab, one of a crossed pair and a cap: one plane",
          [{"shape": "parallel_planes", "center": [0, 0, -5], "id": 5},
           {"shape": "quadric", "coefficients": [0, 0, 0.5, 0, 0, 0, 0, 0, 0, 0], "center": [0, 0, -4], "id": 6},
           {"shape": "plane", "center": [3, 0, -4], "id": 7},
           {"shape": "cylinder", "center": [0.5, 0, -5], "z_range": [-1, 1], "capped": True, "id": 8}],
          {**camera, **CENTRED})  # fmt: skip


@stress
def balls_kiss_on_the_axis() -> tuple[list[Document], Document]:
    """Inner balls touch the outer one at the very point that the middle ray meets."""
    return [ball(0, 0, -4, 1.5, id=3), ball(0, 0, -3.5, 1, id=2), ball(0, 0, -3, 0.5, id=1)], pinhole(**CENTRED)


@stress
def two_spheres_share_a_circle() -> tuple[list[Document], Document]:
    """Who is in front changes on a circle that passes through pixel centres."""
    return [ball(-0.75, 0, -4, 1.25), ball(0.75, 0, -4, 1.25), form(0, 0, 0, 0.5, 0, 0, 0, 0, 0, 0)], orthographic(
        **CENTRED
    )


@stress
def a_shell_of_one_unit() -> tuple[list[Document], Document]:
    """Concentric balls from inside: the farther wall by one unit comes first in the document."""
    return [ball(0, 0, 0, up(2.0)), ball(0, 0, 0, 2), ball(0, 0, 0, up(2.0, 2))], pinhole()


@stress
def forty_equal_balls() -> tuple[list[Document], Document]:
    """Forty copies with ids downwards: the first of all."""
    return [ball(0.1, 0.2, -4, 1.3, id=100 - k) for k in range(40)], pinhole()


@stress
def slabs_in_steps_of_a_unit() -> tuple[list[Document], Document]:
    """Twenty tilted planes, each one unit in the last place behind the next."""
    return [{"shape": "plane", "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0.3, -0.2, 1, up(-4.0, k)], [0, 0, 0, 1]]}
            for k in range(20)], pinhole()  # fmt: skip


@stress
def id_extremes() -> tuple[list[Document], Document]:
    """Ids 1 and 2^32 - 1 in a tie, the larger first."""
    return [ball(0, 0, -4, 1, id=4294967295), ball(0, 0, -4, 1, id=1)], orthographic()
