"""Objects of several variants, told apart by the word at one key: quadrics by shape, cameras by projection."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.document.json_text import RepeatedKeys
from conicoid.document.kinds import Word
from conicoid.document.problems import Problems, key_place, unlike
from conicoid.document.records import Record, explain_repeated
from conicoid.document.sets import Spread, places_within, wrong

_COUNT: Final = "count"


@dataclass(frozen=True)
class Group:
    """n objects of one variant that give the same keys, as columns.

    Attributes:
        variant: the word that tells them apart.
        index: (n,) int64, ascending positions in the document's list, every set counting as its elements.
        columns: key to the column of its n values; see the field's kind for the column's type and shape.
        counts: (n,) int64, the elements of each object where they are sets, whose columns are `Spread`; else None.
    """

    variant: str
    index: NDArray[np.int64]
    columns: dict[str, Any]
    counts: NDArray[np.int64] | None = None

    def __len__(self) -> int:
        """Objects, the elements of sets counted one by one."""
        return len(self.index) if self.counts is None else int(self.counts.sum())

    def expanded(self) -> "Group":
        """The group with every element of its sets as an object of its own; `name` is left out."""
        if self.counts is None:
            return self
        spread = {key: column for key, column in self.columns.items() if isinstance(column, Spread) and key != "name"}
        columns = {key: column.expanded(self.counts) for key, column in spread.items()}
        if "id" in columns:  # one integer is the first of consecutive ids
            places = places_within(self.counts)
            columns["id"] = columns["id"] + np.where(np.repeat(spread["id"].shared, self.counts), places, 0)
        starts = np.cumsum(self.counts) - self.counts
        index = np.repeat(self.index - starts, self.counts)
        index += np.arange(len(index))
        return Group(self.variant, index, columns)


@dataclass(frozen=True)
class Variants:
    """Objects that are each one of several records.

    Attributes:
        noun: what they are, in the singular: `quadric`.
        tag: the key whose word names the record.
        records: the record of each word.
        default: the word where the tag is missing; None if it must be there.
        sets: the record of each word for objects with `count`, which stand for many; empty if there are none.
    """

    noun: str
    tag: str
    records: Mapping[str, Record]
    default: str | None = None
    sets: Mapping[str, Record] = field(default_factory=dict)

    def column(self, values: list[Any]) -> list[Group] | None:
        """The objects in groups; sets that refer to arrays are groups of one."""
        if not set(map(type, values)) <= {dict}:
            return None
        words = [value.get(self.tag, self.default) for value in values]
        if Word(tuple(self.records)).column(words) is None:
            return None
        groups = []
        for index in _same(words, values):
            variant = words[index[0]]
            first = values[index[0]]
            for part in _referring_apart(index, values) if self._is_set(first) else [index]:
                columns = self._record(variant, first).columns([values[i] for i in part.tolist()])
                if columns is None:
                    return None
                groups.append(Group(variant, part, columns, columns.pop(_COUNT, None)))
        return _counted(groups, len(values))

    def _is_set(self, value: dict[str, Any]) -> bool:
        return bool(self.sets) and _COUNT in value

    def _record(self, word: str, value: dict[str, Any]) -> Record:
        return (self.sets if self._is_set(value) else self.records)[word]

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Not an object, no word or a wrong one, or what its record finds."""
        if not isinstance(value, dict):
            problems.add(place, f"{unlike(value, 'an object')}; give a {self.noun} in braces", "scene-type")
            return
        word: Any = value.get(self.tag, self.default)
        known = Word(tuple(self.records))
        if word is None and self.tag not in value:
            message = f"missing; give {self.records[next(iter(self.records))].fields[self.tag].about}"
            problems.add(key_place(place, self.tag), message, "scene-missing")
        elif known.column([word]) is None:
            known.explain(word, key_place(place, self.tag), problems)
        else:
            self._record(word, value).explain(value, place, problems)
            return
        if isinstance(value, RepeatedKeys):
            explain_repeated(value, place, problems)

    def schema(self) -> dict[str, Any]:
        """One schema per record, of which exactly one holds."""
        singles = [self._variant_schema(word, record) for word, record in self.records.items()]
        sets = [self._variant_schema(word, record, _COUNT) for word, record in self.sets.items()]
        return {"oneOf": singles + sets}

    def _variant_schema(self, word: str, record: Record, *needed: str) -> dict[str, Any]:
        schema = record.schema()
        schema["title"] = " of ".join(["set"] * len(needed) + [word.replace("_", " ")])
        about = schema["properties"][self.tag]["description"]
        schema["properties"][self.tag] = {"const": word, "description": about}
        if word == self.default:
            schema["properties"][self.tag]["default"] = word
        else:
            schema["required"] = [self.tag, *needed, *(key for key in record.required if key != self.tag)]
        return schema


def _same(words: list[str], objects: list[dict[str, Any]]) -> list[NDArray[np.int64]]:
    """Positions of the objects that share their word and their keys, whatever the order of the keys."""
    # Each object is labelled by the first one like it, without a step of Python per object.
    first: dict[tuple[str, tuple[str, ...]], int] = {}
    likes = map(first.setdefault, zip(words, map(tuple, objects), strict=True), count())
    labels = np.fromiter(likes, np.int64, len(objects))
    relabelled = np.arange(len(objects))
    unordered: dict[tuple[str, frozenset[str]], int] = {}
    for (word, keys), label in first.items():
        relabelled[label] = unordered.setdefault((word, frozenset(keys)), label)
    labels = relabelled[labels]
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(labels[order])) + 1) if len(order) else []


def _referring_apart(index: NDArray[np.int64], sets: list[dict[str, Any]]) -> list[NDArray[np.int64]]:
    """Positions of sets in parts: each that refers to an array alone, the others together."""
    refers = np.array([any(isinstance(value, np.ndarray) for value in sets[i].values()) for i in index.tolist()])
    together = [index[~refers]] if not refers.all() else []
    return [*together, *index[refers][:, None]]


def _counted(groups: list[Group], n: int) -> list[Group]:
    """The groups of n objects with every set counting as its elements in their positions."""
    if all(group.counts is None for group in groups):
        return groups
    sizes = np.ones(n, np.int64)
    for group in groups:
        if group.counts is not None:
            sizes[group.index] = group.counts
    starts = np.cumsum(sizes) - sizes
    return [replace(group, index=starts[group.index]) for group in groups]


@dataclass(frozen=True)
class ListOf:
    """A list of at least so many of such objects, which is wherever it stands the only one of its kind."""

    item: Variants
    least: int = 0

    def column(self, values: list[Any]) -> list[Group] | None:
        """The groups of one list's objects."""
        (value,) = values
        return self.item.column(value) if isinstance(value, list) and len(value) >= self.least else None

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Not a list, or wrong objects in it: a wrong one among n right ones is found in the time of a few passes."""
        if not isinstance(value, list):
            message = f"{unlike(value, 'a list')}; give a list of {self.item.noun}s"
            problems.add(place, message, "scene-type")
            return
        if len(value) < self.least:
            problems.add(place, f"the list is empty; give a {self.item.noun}", "scene-length")
        for i in wrong(self.item.column, value):
            self.item.explain(value[i], f"{place}[{i}]", problems)

    def schema(self) -> dict[str, Any]:
        """An array of objects."""
        schema = {"type": "array", "items": self.item.schema()}
        return schema | {"minItems": self.least} if self.least else schema
