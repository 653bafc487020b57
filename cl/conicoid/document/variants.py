"""Objects of several variants, told apart by the word at one key: quadrics by shape, cameras by projection."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.document.json_text import RepeatedKeys
from conicoid.document.kinds import Word
from conicoid.document.problems import Problems, key_place, unlike
from conicoid.document.records import Record, explain_repeated


@dataclass(frozen=True)
class Group:
    """n objects of one variant that give the same keys, as columns.

    Attributes:
        variant: the word that tells them apart.
        index: (n,) int64, ascending positions in the document's list.
        columns: key to the column of its n values; see the field's kind for the column's type and shape.
    """

    variant: str
    index: NDArray[np.int64]
    columns: dict[str, Any]


@dataclass(frozen=True)
class Variants:
    """Objects that are each one of several records.

    Attributes:
        noun: what they are, in the singular: `quadric`.
        tag: the key whose word names the record.
        records: the record of each word.
        default: the word where the tag is missing; None if it must be there.
    """

    noun: str
    tag: str
    records: Mapping[str, Record]
    default: str | None = None

    def column(self, values: list[Any]) -> list[Group] | None:
        """The objects in groups, the group of the first object first."""
        if not set(map(type, values)) <= {dict}:
            return None
        words = [value.get(self.tag, self.default) for value in values]
        if Word(tuple(self.records)).column(words) is None:
            return None
        groups = []
        for index in _same(words, values):
            variant = words[index[0]]
            columns = self.records[variant].columns([values[i] for i in index.tolist()])
            if columns is None:
                return None
            groups.append(Group(variant, index, columns))
        return groups

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
            self.records[word].explain(value, place, problems)
            return
        if isinstance(value, RepeatedKeys):
            explain_repeated(value, place, problems)

    def schema(self) -> dict[str, Any]:
        """One schema per record, of which exactly one holds."""
        return {"oneOf": [self._variant_schema(word) for word in self.records]}

    def _variant_schema(self, word: str) -> dict[str, Any]:
        record = self.records[word]
        schema = record.schema()
        schema["title"] = word.replace("_", " ")
        about = schema["properties"][self.tag]["description"]
        schema["properties"][self.tag] = {"const": word, "description": about}
        if word == self.default:
            schema["properties"][self.tag]["default"] = word
        else:
            schema["required"] = [self.tag, *(key for key in record.required if key != self.tag)]
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


@dataclass(frozen=True)
class ListOf:
    """A list of such objects, which is wherever it stands the only one of its kind."""

    item: Variants

    def column(self, values: list[Any]) -> list[Group] | None:
        """The groups of one list's objects."""
        (value,) = values
        return self.item.column(value) if isinstance(value, list) else None

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Not a list, or wrong objects in it: a wrong one among n right ones is found in the time of a few passes."""
        if not isinstance(value, list):
            message = f"{unlike(value, 'a list')}; give a list of {self.item.noun}s"
            problems.add(place, message, "scene-type")
            return
        for i in _wrong(self.item, value):
            self.item.explain(value[i], f"{place}[{i}]", problems)

    def schema(self) -> dict[str, Any]:
        """An array of objects."""
        return {"type": "array", "items": self.item.schema()}


def _wrong(item: Variants, objects: list[Any]) -> Iterator[int]:
    """Positions of the objects that are wrong, ascending, by bisection."""
    pending = [range(len(objects))]
    while pending:
        part = pending.pop()
        if item.column(objects[part.start : part.stop]) is not None:
            continue
        if len(part) == 1:
            yield part.start
        else:
            middle = len(part) // 2
            pending += [part[middle:], part[:middle]]
