"""Objects of several variants, told apart by the word at one key: quadrics by shape, cameras by projection."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
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
        groups = []
        for variant, index in self._same_keys(values):
            if variant not in self.records:
                return None
            columns = self.records[variant].columns([values[i] for i in index])
            if columns is None:
                return None
            groups.append(Group(variant, np.array(index, dtype=np.int64), columns))
        return groups

    def _same_keys(self, objects: list[dict[str, Any]]) -> Iterator[tuple[str, list[int]]]:
        """The word and the positions of the objects that share it and their keys, whatever the order of the keys."""
        by_order: dict[tuple[str, ...], list[int]] = {}
        for i, keys in enumerate(map(tuple, objects)):
            by_order.setdefault(keys, []).append(i)
        by_word: dict[tuple[str, frozenset[str]], list[int]] = {}
        for order, index in by_order.items():
            key_set = frozenset(order)
            for i in index:
                word = objects[i].get(self.tag, self.default)
                by_word.setdefault((word if isinstance(word, str) else "", key_set), []).append(i)
        for (word, _), index in sorted(by_word.items(), key=lambda item: min(item[1])):
            yield word, sorted(index)

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
