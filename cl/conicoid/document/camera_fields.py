"""The keys of a camera, projection by projection."""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from conicoid.document.camera import focal_from_angle, focal_from_height, is_across
from conicoid.document.kinds import Word
from conicoid.document.numeric import Numbers
from conicoid.document.problems import show, show_numbers
from conicoid.document.quadric_fields import IDENTITY
from conicoid.document.records import Field, Record, Relation
from conicoid.document.rules import AFFINE, CROP, NONZERO_DIRECTION, RIGID
from conicoid.document.variants import Variants
from conicoid.scene import Floats

MOST_PIXELS_A_SIDE: Final = 1 << 24


def _side(which: str) -> Field:
    noun = f"an integer from 1 to {MOST_PIXELS_A_SIDE}"
    return Field(Numbers(noun, whole=True, least=1, most=MOST_PIXELS_A_SIDE), f"the whole image's {which} in pixels")


def _finite_focal(key: str, size: str, focal: Callable[[NDArray[np.int64], Floats], Floats]) -> Relation:
    """The focal length that `key` and the image's `size` make is a number."""
    return Relation(
        (size, key),
        lambda pixels, value: np.isfinite(focal(pixels, value)),
        at=key,
        message=lambda _, value: f"{show(value)} is too small: the focal length overflows; give a larger {key}",
    )


def _crop_inside(size: str, end: int) -> Relation:
    return Relation(
        ("crop", size),
        lambda crops, sizes: crops[:, end] <= sizes,
        at="crop",
        message=lambda crop, pixels: (
            f"{show_numbers(crop)} reaches beyond the image's {size} of {pixels}; give a window inside it"
        ),
    )


_POINT: Final = Numbers("[x, y, z]", (3,))
_LOOK_AT: Final = Record(
    noun="a view from eye to target",
    fields={
        "eye": Field(_POINT, "the camera's world position [x, y, z]"),
        "target": Field(_POINT, "a world position [x, y, z] in the middle of the view"),
        "up": Field(
            Numbers("[x, y, z]", (3,), rules=(NONZERO_DIRECTION,)),
            "a world direction [x, y, z] that is up in the image, of any length but zero",
        ),
    },
    required=("eye", "target", "up"),
    relations=(
        Relation(
            ("eye", "target"),
            lambda eye, target: (eye != target).any(axis=1),
            at="target",
            message=lambda _, target: f"{show_numbers(target)} is the eye itself; give a target away from it",
        ),
        Relation(
            ("eye", "target", "up"),
            lambda eye, target, up: (eye == target).all(axis=1) | is_across(eye, target, up),
            at="up",
            message=lambda *values: (
                f"{show_numbers(values[2])} is parallel to the view, or as good as; give an up across it"
            ),
        ),
    ),
)
_LENS: Final = {
    "cx": Field(Numbers("a number of pixels"), "the principal point's u in pixels; width / 2 where not given"),
    "cy": Field(Numbers("a number of pixels"), "the principal point's v in pixels; height / 2 where not given"),
}
_POSE: Final = {
    "convention": Field(
        Word(("opengl", "opencv")),
        "the axes of world_from_camera: opengl looks down -z with +y up, opencv down +z with +y down",
        "opengl",
    ),
    "world_from_camera": Field(
        Numbers("a 4x4 matrix in four rows", (4, 4), rules=(AFFINE, RIGID)),
        "the camera's pose, a rigid 4x4 matrix in rows",
        IDENTITY,
    ),
    "look_at": Field(_LOOK_AT, "the camera's pose by what it looks at, in place of world_from_camera"),
}
_RANGE: Final = {
    "near": Field(Numbers("a depth >= 0", least=0), "the least planar depth that is kept, in world units", 0),
    "far": Field(Numbers("a depth >= near", least=0), "the greatest planar depth that is kept, in world units"),
    "crop": Field(
        Numbers("[x0, y0, x1, y1]", (4,), whole=True, least=0, most=MOST_PIXELS_A_SIDE, rules=(CROP,)),
        "the window of pixels [x0, y0, x1, y1) that is rendered; the whole image where not given",
    ),
}
_FOCAL_NOUN: Final = Numbers("a positive number of pixels", above=0)


def _record(noun: str, lens: dict[str, Field], choices: tuple[tuple[str, ...], ...], *focal: Relation) -> Record:
    frame = {"projection": _PROJECTION, "width": _side("width"), "height": _side("height")}
    return Record(
        noun=noun,
        fields=frame | lens | _LENS | _POSE | _RANGE,
        required=("width", "height"),
        choices=choices,
        apart=(("look_at", "world_from_camera"),),
        relations=(
            *focal,
            Relation(
                ("near", "far"),
                lambda near, far: near <= far,
                at="far",
                message=lambda near, far: f"{show(far)} is before near, {show(near)}; give far >= near",
            ),
            _crop_inside("width", 2),
            _crop_inside("height", 3),
        ),
    )


_PROJECTION: Final = Field(Word(("pinhole", "orthographic")), "how pixels make rays", "pinhole")
_ANGLE: Final = Numbers("an angle between 0 and 180", above=0, below=180)
_PINHOLE: Final = _record(
    "a pinhole camera",
    {
        "fov_y": Field(_ANGLE, "the vertical field of view in degrees"),
        "fov_x": Field(_ANGLE, "the horizontal field of view in degrees"),
        "fx": Field(_FOCAL_NOUN, "the focal length in pixels along u"),
        "fy": Field(_FOCAL_NOUN, "the focal length in pixels along v"),
    },
    (("fov_y",), ("fov_x",), ("fx", "fy")),
    _finite_focal("fov_y", "height", focal_from_angle),
    _finite_focal("fov_x", "width", focal_from_angle),
)
_ORTHOGRAPHIC: Final = _record(
    "an orthographic camera",
    {
        "view_height": Field(
            Numbers("a positive height", above=0), "the height of the view in world units, over the image's height"
        ),
        "fx": Field(_FOCAL_NOUN, "pixels per world unit along u"),
        "fy": Field(_FOCAL_NOUN, "pixels per world unit along v"),
    },
    (("view_height",), ("fx", "fy")),
    _finite_focal("view_height", "height", focal_from_height),
)
CAMERA: Final = Variants(
    "camera", "projection", {"pinhole": _PINHOLE, "orthographic": _ORTHOGRAPHIC}, default="pinhole"
)
