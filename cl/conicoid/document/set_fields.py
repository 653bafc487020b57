"""The keys of a set of quadrics: those of one quadric, each for every element or shared, and `count`."""

from typing import Final, cast

import numpy as np
from numpy.typing import NDArray

from conicoid.document.numeric import Numbers
from conicoid.document.records import Field, Record, Relation
from conicoid.document.sets import ElementKind, PerElement, Spread

MOST_ID: Final = 2**32 - 1

_COUNT = Field(Numbers("a number of quadrics", whole=True, least=0, most=MOST_ID), "how many quadrics the set has")
_PLAIN: Final = {
    "shape": "the shape of all the quadrics of the set, a word such as sphere",
    "id": "the ids of the quadrics, in a list, or the first of consecutive ones; where not given, a quadric's position "
    "among all quadrics of the document, from 1",
}


def set_record(name: str, one: Record) -> Record:
    """The record of sets of a shape, from the record of one quadric of that shape."""
    spread = [key for key in one.fields if key != "shape"]
    fields = {key: _spread(key, one.fields[key]) for key in spread}
    shape = Field(one.fields["shape"].kind, _PLAIN["shape"])
    return Record(
        noun=f"a set of shape {name}",
        fields={"shape": shape, "count": _COUNT} | fields,
        choices=one.choices,
        apart=one.apart,
        relations=(*map(_one_for_each, spread), _CAPS_NEED_RANGE, _IDS_FIT),
        extra_schema=_CAPS_SCHEMA,
    )


def _spread(key: str, one: Field) -> Field:
    about = _PLAIN.get(key, f"{one.about}; one for each quadric in a list, or one that all share")
    return Field(PerElement(cast("ElementKind", one.kind)), about, one.default)


def _one_for_each(key: str) -> Relation:
    return Relation(
        (key, "count"),
        lambda spread, counts: spread.shared | (spread.lengths == counts),
        at=key,
        message=lambda values, count: (
            f"{len(values)} values are not one for each of {count}; give as many as count says, or one that all share"
        ),
        code="scene-length",
    )


def _ids_fit(spread: Spread, counts: NDArray[np.int64]) -> NDArray[np.bool_]:
    shared = spread.shared
    fits = ~shared
    fits[shared] = spread.column[spread.first_rows()[shared]] + counts[shared] - 1 <= MOST_ID
    return fits


_IDS_FIT: Final = Relation(
    ("id", "count"),
    _ids_fit,
    at="id",
    message=lambda first, count: (
        f"{count} consecutive ids from {first} run beyond {MOST_ID}; give a lower first id, or a list"
    ),
)
_CAPS_NEED_RANGE: Final = Relation(
    ("capped",),
    lambda spread: np.logical_not(spread.column),
    at="capped",
    message=lambda _: "true needs z_range, where the caps are; give z_range or leave capped out",
    unless="z_range",
    code="scene-missing",
)
_CAPS_SCHEMA: Final = {
    "if": {
        "required": ["capped"],
        "properties": {"capped": {"anyOf": [{"const": True}, {"type": "array", "contains": {"const": True}}]}},
    },
    "then": {"required": ["z_range"]},
}
