"""The keys of a quadric, shape by shape."""

from typing import Final

import numpy as np

from conicoid.document.kinds import Flag, Text, Word
from conicoid.document.numeric import Numbers, Rows
from conicoid.document.records import Field, Record, Relation
from conicoid.document.rules import (
    AFFINE,
    ASCENDING,
    INVERTIBLE,
    NONZERO_COEFFICIENTS,
    NONZERO_FORM,
    NONZERO_QUATERNION,
    SYMMETRIC,
)
from conicoid.document.set_fields import MOST_ID, set_record
from conicoid.document.variants import ListOf, Variants
from conicoid.shapes import SHAPES, Shape

MOST_CLIPS: Final = 8
IDENTITY: Final = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]

_SHAPE = Field(Word(tuple(shape.name for shape in SHAPES)), "the quadric's shape, a word such as sphere")
_RADIUS = Numbers("a positive radius", above=0)
_PLACEMENT: Final = {
    "transform": Field(
        Numbers("a 4x4 matrix in four rows", (4, 4), rules=(AFFINE, INVERTIBLE)),
        "world_from_object as an affine 4x4 matrix in rows, in place of center and rotation",
    ),
    "center": Field(Numbers("[x, y, z]", (3,)), "the world position [x, y, z] of the object's origin", [0, 0, 0]),
    "rotation": Field(
        Numbers("a quaternion [x, y, z, w]", (4,), rules=(NONZERO_QUATERNION,)),
        "the rotation from object to world as a quaternion [x, y, z, w] of any length but zero",
        [0, 0, 0, 1],
    ),
}
_EXTENT: Final = {
    "z_range": Field(
        Numbers("[z0, z1]", (2,), rules=(ASCENDING,)),
        "the closed range [z0, z1] of object-space z that is kept",
    ),
    "capped": Field(Flag(), "whether flat discs close the surface at both ends of z_range", False),
    "clip": Field(
        Rows(Numbers("[a, b, c, d]", (4,)), MOST_CLIPS),
        "world half-spaces [a, b, c, d]; what is kept has ax + by + cz + d >= 0 in all of them",
        [],
    ),
}
_NAMING: Final = {
    "id": Field(
        Numbers(f"an integer from 1 to {MOST_ID}", whole=True, least=1, most=MOST_ID),
        "the number of the quadric in the id channel; its position among all quadrics, from 1, where not given",
    ),
    "name": Field(Text(), "free text, which changes nothing"),
}
_CAPS_NEED_RANGE = Relation(
    ("capped",),
    np.logical_not,
    at="capped",
    message=lambda _: "true needs z_range, where the caps are; give z_range or leave capped out",
    unless="z_range",
    code="scene-missing",
)


def _parameters(shape: Shape) -> dict[str, Field]:
    if shape.name == "quadric":
        return {
            "matrix": Field(
                Numbers("a symmetric 4x4 matrix in four rows", (4, 4), rules=(SYMMETRIC, NONZERO_FORM)),
                "the symmetric 4x4 matrix Q of f = x^T Q x, in rows",
            ),
            "coefficients": Field(
                Numbers("[A, B, C, D, E, F, G, H, I, J]", (10,), rules=(NONZERO_COEFFICIENTS,)),
                "[A, B, C, D, E, F, G, H, I, J] of f = Ax^2 + 2Bxy + 2Cxz + 2Dx + Ey^2 + 2Fyz + 2Gy + Hz^2 + 2Iz + J",
            ),
        }
    fields = {}
    if shape.radius:
        fields["radius"] = Field(_RADIUS, "the radius, in world units: all the shape's radii at once", 1)
    if shape.radii > 1:
        letters = f"[{', '.join('abc'[: shape.radii])}]"
        fields["radii"] = Field(
            Numbers(f"positive radii {letters}", (shape.radii,), above=0),
            f"the radii {letters}, in world units",
            [1] * shape.radii,
        )
    return fields


def _record(shape: Shape) -> Record:
    parameters = _parameters(shape)
    return Record(
        noun=f"{'an' if shape.name[0] in 'aeiou' else 'a'} {shape.name}",
        fields={"shape": _SHAPE} | parameters | _PLACEMENT | _EXTENT | _NAMING,
        choices=(("matrix",), ("coefficients",)) if shape.name == "quadric" else (),
        apart=(
            *([("radii", "radius")] if {"radius", "radii"} <= parameters.keys() else []),
            ("center", "transform"),
            ("rotation", "transform"),
        ),
        relations=(_CAPS_NEED_RANGE,),
        extra_schema={
            "if": {"required": ["capped"], "properties": {"capped": {"const": True}}},
            "then": {"required": ["z_range"]},
        },
    )


_RECORDS: Final = {shape.name: _record(shape) for shape in SHAPES}
_SETS: Final = {name: set_record(name, record) for name, record in _RECORDS.items()}
QUADRICS: Final = ListOf(Variants("quadric", "shape", _RECORDS, sets=_SETS))
