"""Planes, sheets and caps that tie with near, far, ranges, clips and each other over whole images."""

from tests.scenes.catalogue import PROJECTIONS, Document
from tests.scenes.floods import CAN, CORNER, GROUND, SLAB, TURN, WALL, box, room, turned_normal
from tests.scenes.stress import CENTRED, ball, enter, form, orthographic, pinhole, posed, stress, up

for projection, camera in zip(PROJECTIONS, (pinhole(), orthographic()), strict=True):
    for end in ("near", "far"):
        for label, depth in (("at", 5.0), ("after", up(5.0)), ("before", up(5.0, -1))):
            enter(f"{end}_{label}_a_wall_{projection}", f"{end} = {depth!r}, and a slab, a wall and a corner at 5",
                  [{**SLAB, "clip": [[1, 0, 0, 1]]}, {**WALL, "clip": [[-1, 0, 0, 0.5]]}, CORNER],
                  {**camera, end: depth})  # fmt: skip
    for label, offset in (("at", 5.0), ("after", up(5.0)), ("before", up(5.0, -1))):
        clip = [[0, 0, 2, 2 * offset], [0, 0, -1, -up(offset, -2)]]
        enter(f"clip_{label}_a_wall_{projection}", "half-spaces that end on a wall, a slab, a corner, a cap, or nearly",
              [{**SLAB, "clip": clip[1:]}, {**WALL, "clip": clip}, {**CORNER, "clip": clip[:1]},
               {**CAN, "clip": clip[1:]}], camera, normal_side="outward")  # fmt: skip
    enter(f"clip_nearly_a_turned_wall_{projection}", "a clip that crosses the plane it is meant to be, in the image",
          [{**WALL, "rotation": TURN, "clip": [[*turned_normal(), 5 * turned_normal()[2]]]},
           {**SLAB, "rotation": TURN, "center": [0, 0, -8], "clip": [[*turned_normal(), 8 * turned_normal()[2] - 1]]}],
          camera)  # fmt: skip
    for label, ends in (("above", [0, 1]), ("below", [-1, 0]), ("flat", [0, 0]), ("a_unit_off", [-5e-324, 1])):
        enter(f"plane_capped_{label}_{projection}", "caps in the plane itself, on both its sides",
              [{**WALL, "rotation": TURN, "z_range": ends, "capped": True}], camera, normal_side="outward")  # fmt: skip
    for label, ends in (("within", [-1, 1]), ("half", [-1, 0.5]), ("nearly", [up(-1.0, -1), up(1.0, -1)])):
        enter(f"slab_capped_{label}_{projection}", "caps in the sheets of a slab, or a unit off them",
              [{**SLAB, "rotation": TURN, "z_range": ends, "capped": True}], camera, normal_side="outward")  # fmt: skip
    enter(f"walls_a_unit_apart_{projection}", "a wall, a slab, a corner and a cap, each a unit behind the next",
          [{**CAN, "radius": 1}, {**SLAB, "radius": up(1.0), "clip": [[1, 0, 0, 0.5]]},
           {**WALL, "center": [0, 0, up(-5.0)]},
           form(0, 0, 0.5, up(5.0, -2) / 2, 0, 0, 0, 0, 0, 0)], camera)  # fmt: skip
    for label, size in (("thin", 1e-17), ("thinner", 1e-40)):
        enter(f"coin_and_slab_{label}_{projection}", "two faces that no depth tells apart",
              [{**CAN, "rotation": TURN, "z_range": [0, size]}, {**SLAB, "rotation": TURN, "radius": size,
               "clip": [[-1, 0, 0, 0]], "center": [0, 0, -8]}], camera, normal_side="outward")  # fmt: skip
    enter(f"a_fan_of_one_unit_{projection}", "planes a unit of slope apart, through one line behind a column of pixels",
          [{"shape": "plane", "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [up(0.3, k), 0, 1, -4], [0, 0, 0, 1]]}
           for k in (5, 0, 7, 2, 9, 1, 8, 3)], {**camera, "fx": 11, "cx": 7.5})  # fmt: skip
    enter(f"sheets_and_walls_{projection}", "both sheets of a slab, and a cap, are planes of the document too",
          [{**WALL, "clip": [[1, 0, 0, 1]]}, SLAB, {**WALL, "center": [0, 0, -7]}, CAN], camera)  # fmt: skip
    enter(f"edge_of_a_corner_{projection}", "where two sheets cross, at pixel centres; near on one of them",
          [CORNER], {**camera, **CENTRED, "near": 5}, normal_side="outward")  # fmt: skip
    enter(f"irrational_sheets_{projection}", "x^2 = 2 (z + 5)^2, clipped by planes through its edge",
          [form(1, 0, 0, 0, 0, 0, 0, -2, -10, -50, clip=[[0, 0, 1, 5], [1, 0, 1.25, 6.25]])],
          {**camera, **CENTRED})  # fmt: skip
    enter(f"boxes_in_a_stack_{projection}", "cubes of clipped slabs that share faces, edges and corners",
          [*box(-1, -1, -7), *box(-1, 1, -7), *box(1, -1, -7)], {**camera, **posed(0.25, 0.5, 0)})  # fmt: skip
    enter(f"cans_on_glass_{projection}", "a table from below, what stands on it, and what is stuck to it",
          [{"shape": "plane", "rotation": [0, 0.6, 0, 0.8], "clip": [[-1, 0, 0, 0]]},
           *({"shape": "cylinder", "radius": 0.5, "transform": [[0.28, 0, 0.96, x], [0, 1, 0, y], [-0.96, 0, 0.28, z],
              [0, 0, 0, 1]], "z_range": ends, "capped": True}
             for x, y, z, ends in ((0, 0, 0, [0, 1]), (0, 0.5, 0, [0, 0.5]), (0, 1, 0, [-0.25, 0])))],
          {**camera, "world_from_camera": [[1, 0, 0, -0.5], [0, 1, 0, 0.25], [0, 0, 1, 3], [0, 0, 0, 1]]})  # fmt: skip


@stress
def clipped_ground() -> tuple[list[Document], Document]:
    """y = 0 with the clip y >= 0, and a ball on it."""
    return [{**GROUND, "clip": [[0, 1, 0, 0]]}, ball(0, 1, -5, 1)], pinhole(**posed(0, 1.5, 0))


@stress
def eye_on_the_ground() -> tuple[list[Document], Document]:
    """The eye in a plane, in a sheet, in a cap and in a clip's plane: none of them is seen."""
    return [
        GROUND,
        {**GROUND, "shape": "crossed_planes"},
        {"shape": "cylinder", "center": [0, 0, -4], "rotation": [1, 0, 0, 1], "z_range": [-1, 0], "capped": True},
        ball(0, 0, -6, 3, clip=[[0, 1, 0, 0]]),
    ], pinhole(**CENTRED)


@stress
def ground_edge_on() -> tuple[list[Document], Document]:
    """Parallel rays along a plane, a sheet and a cap: none of them is seen."""
    return [
        GROUND,
        {**GROUND, "shape": "crossed_planes"},
        {"shape": "cylinder", "center": [0, 0, -4], "rotation": [1, 0, 0, 1], "z_range": [-1, 0], "capped": True},
    ], orthographic(**CENTRED)


@stress
def a_room_of_clipped_planes() -> tuple[list[Document], Document]:
    """Five walls, each clipped by all five half-spaces, the eye on the sixth."""
    walls = room([1, 0, 0, 2], [-1, 0, 0, 2], [0, 1, 0, 1.5], [0, -1, 0, 1.5], [0, 0, 1, 5])
    return walls, pinhole(fx=8, fy=8)


@stress
def parts_of_one_cylinder_miss() -> tuple[list[Document], Document]:
    """Parallel rays that hit one part of a surface and miss another do not tie with what they miss."""
    common = {"center": [0.1, -0.05, -4], "rotation": [0.3, 0.2, 0.1, 0.9]}
    return [
        {"shape": "cylinder", **common, "z_range": [-1, -0.25]},
        {"shape": "cylinder", **common, "z_range": [-0.25, 0]},
        {"shape": "cylinder", **common, "z_range": [-0.25, 1], "clip": [[1, 0, 0, 0]]},
    ], orthographic()
