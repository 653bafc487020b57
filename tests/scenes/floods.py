"""`FLOODS`: scenes as users write them where planes, sheets or caps tie with something at every pixel."""

import math

from tests.scenes.catalogue import PROJECTIONS, Document, document
from tests.scenes.stress import form, up

TURN = [0.1, 0.2, 0, 1]
WALL: Document = {"shape": "plane", "center": [0, 0, -5]}
SLAB: Document = {"shape": "parallel_planes", "center": [0, 0, -6]}
CAN: Document = {"shape": "cylinder", "radius": 3, "center": [0, 0, -6], "z_range": [-1, 1], "capped": True}
# f = x (z + 5): one sheet along the view, one across it.
CORNER = form(0, 0, 0.5, 2.5, 0, 0, 0, 0, 0, 0)
# y = 0, seen from above.
GROUND: Document = {"shape": "plane", "transform": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]}
STANDING: Document = {"world_from_camera": [[1, 0, 0, 0], [0, 1, 0, 1.5], [0, 0, 1, 4], [0, 0, 0, 1]]}
HALF: Document = {"shape": "sphere", "center": [0, 0, -4], "radius": 1.75, "rotation": TURN, "capped": True}
CHANNELS = ["Z", "ZBack", "N", "id"]

# The document's quadrics and what its camera says besides its size, by name; for a pinhole and for parallel rays.
FLOODS: dict[str, tuple[list[Document], Document]] = {}


def turned_normal() -> list[float]:
    """The z axis under TURN, as someone would compute it: not quite the plane's own normal."""
    x, y, z, w = (value / math.hypot(*TURN) for value in TURN)
    return [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]


def turned_can(height: float) -> Document:
    """A can of height 1 along the turned axis, clipped by the planes of its caps, or nearly."""
    normal = turned_normal()
    centre = [height * axis for axis in normal[:2]] + [height * normal[2] - 8]
    offset = sum(axis * place for axis, place in zip(normal, centre, strict=True))
    clips = [[*normal, 0.5 - offset], [*[-axis for axis in normal], 0.5 + offset]]
    return {"shape": "cylinder", "radius": 2, "rotation": TURN, "center": centre, "z_range": [-0.5, 0.5],
            "capped": True, "clip": clips}  # fmt: skip


def room(*walls: list[float]) -> list[Document]:
    """Planes a x + b y + c z + d = 0, each clipped by all the half-spaces a x + b y + c z + d >= 0."""
    return [form(0, 0, 0, a / 2, 0, 0, b / 2, 0, c / 2, d, clip=list(walls)) for a, b, c, d in walls]


def box(x: float, y: float, z: float) -> list[Document]:
    """A cube of side 2: three slabs, each clipped by the faces of all three."""
    faces = [[1, 0, 0, 1 - x], [-1, 0, 0, 1 + x], [0, 1, 0, 1 - y], [0, -1, 0, 1 + y], [0, 0, 1, 1 - z],
             [0, 0, -1, 1 + z]]  # fmt: skip
    columns = ([0, 1, 2], [1, 2, 0], [2, 0, 1])
    turns = [[[float(row == column) for column in order] for row in range(3)] for order in columns]
    return [
        {"shape": "parallel_planes", "clip": faces,
         "transform": [[*row, at] for row, at in zip(turn, (x, y, z), strict=True)] + [[0, 0, 0, 1]]}
        for turn in turns
    ]  # fmt: skip


def flood(name: str, size: tuple[int, int]) -> Document:
    """The document of a flood, of some width and height."""
    quadrics, camera = FLOODS[name]
    width, height = size
    view = (
        {"view_height": 3} if camera.get("projection") == "orthographic" else {"fx": 0.75 * width, "fy": 0.75 * width}
    )
    numbered = [{**quadric, "id": k + 1} for k, quadric in enumerate(quadrics)]
    return document(numbered, {"width": width, "height": height, **view, **camera}, channels=CHANNELS)


for _projection in PROJECTIONS:
    _rays = {} if _projection == "pinhole" else {"projection": _projection}
    for _name, _quadrics, _camera in (
        ("near at a wall", [WALL], {"near": 5}),
        ("far at a wall", [WALL], {"far": 5}),
        ("near a unit after a slab", [SLAB], {"near": up(5.0)}),
        ("far at the back of a slab", [SLAB], {"far": 7}),
        ("near at a sheet of a corner", [CORNER], {"near": 5}),
        ("near at a cap", [CAN], {"near": 5}),
        ("a clip on its wall", [{**WALL, "clip": [[0, 0, 1, 5]]}], {}),
        ("a clip on its turned wall, nearly",
         [{**WALL, "rotation": TURN, "clip": [[*turned_normal(), 5 * turned_normal()[2]]]}], {}),
        ("a clip on a cap", [{**CAN, "clip": [[0, 0, -1, -5]]}], {}),
        ("a plane capped at 0", [{**WALL, "z_range": [0, 1], "capped": True}], {}),
        ("a slab capped at its sheets", [{**SLAB, "rotation": TURN, "z_range": [-1, 1], "capped": True}], {}),
        ("walls a unit apart", [WALL, {**WALL, "center": [0, 0, up(-5.0)]}, CORNER], {}),
        ("walls that cross at a unit",
         [{"shape": "plane", "transform": [[1, 0, 0, 0], [0, 1, 0, 0], [slope, 0, 1, -4], [0, 0, 0, 1]]}
          for slope in (0.25, up(0.25))], {}),
        ("a slab a unit before a cap", [CAN, {**SLAB, "radius": up(1.0)}], {}),
        ("a slab and walls in its sheets", [WALL, SLAB, {**WALL, "center": [0, 0, -7]}], {}),
        ("a thin coin", [{**CAN, "radius": 9, "rotation": TURN, "z_range": [0, 1e-17]}], {}),
        ("a thin slab", [{**SLAB, "rotation": TURN, "radius": 1e-17}], {}),
        ("half balls that share a cap", [{**HALF, "z_range": [-1.75, 0]}, {**HALF, "z_range": [0, 1.75]}], {}),
        ("turned cans in a stack, clipped", [turned_can(float(height)) for height in range(4)], {}),
    ):  # fmt: skip
        FLOODS[f"{_name}, {_projection}"] = (_quadrics, {**_camera, **_rays})
FLOODS["a ground clipped at its height"] = ([{**GROUND, "clip": [[0, 1, 0, 0]]}, {"shape": "sphere"}], STANDING)
FLOODS["eye on the ground"] = ([GROUND, {**CAN, "rotation": [1, 0, 0, 1], "z_range": [-1, 0]}], {})
FLOODS["a can on a glass table, from below"] = (
    [GROUND, {**GROUND, "shape": "cylinder", "radius": 2, "z_range": [0, 1], "capped": True}],
    {"world_from_camera": [[1, 0, 0, 0], [0, 0, -1, -3], [0, 1, 0, 0], [0, 0, 0, 1]]},
)
FLOODS["a room of clipped planes"] = (
    room([1, 0, 0, 3], [-1, 0, 0, 3], [0, 1, 0, 2], [0, -1, 0, 2], [0, 0, 1, 5]),
    {},
)
FLOODS["boxes of clipped slabs in a stack"] = (
    [quadric for y in (-2, 0, 2) for x in (-1, 1) for quadric in box(x, y, -6)],
    {"world_from_camera": [[1, 0, 0, 0.5], [0, 1, 0, 0.25], [0, 0, 1, 0], [0, 0, 0, 1]]},
)
