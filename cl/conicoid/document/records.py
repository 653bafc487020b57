"""Objects: which keys they take, which of those exclude or need each other, and relations between their values."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.document.json_text import RepeatedKeys
from conicoid.document.kinds import Kind, one_of
from conicoid.document.problems import Problems, key_place, unlike

_KeyProblem = tuple[str | None, str, str]  # the key at fault (None: the object itself), message, code


@dataclass(frozen=True)
class Field:
    """One key of an object.

    Attributes:
        kind: what its value may be.
        about: what it means, with its unit: a sentence for the schema and for whoever has to add it.
        default: what its absence means, as JSON; None where that is not one value.
    """

    kind: Kind
    about: str
    default: Any = None


@dataclass(frozen=True)
class Relation:
    """What values of different keys of one object must satisfy together.

    Attributes:
        keys: the keys, checked where all of them are given.
        holds: columns of the keys to (n,) bool.
        at: the key at whose place a problem is noted.
        message: for the JSON values of the keys, where it does not hold: value, rule and remedy.
        unless: a key whose presence settles it.
        code: of the problem.
    """

    keys: tuple[str, ...]
    holds: Callable[..., NDArray[np.bool_]]
    at: str
    message: Callable[..., str]
    unless: str = ""
    code: str = "scene-value"

    def is_broken(self, columns: Mapping[str, Any], given: Mapping[str, Any]) -> bool:
        """Whether it does not hold for an object with the `given` keys, of which those in `columns` are right."""
        if self.unless in given or not all(key in columns for key in self.keys):
            return False
        return not self.holds(*(columns[key] for key in self.keys)).all()


@dataclass(frozen=True)
class Record:
    """An object with fixed keys.

    Attributes:
        noun: what it is, with its article: `a sphere`.
        fields: all its keys.
        required: keys that must be there.
        choices: sets of keys, exactly one of which must be there.
        usual: the key that is missed where none of the choices is there; the object itself if empty.
        apart: pairs of keys that exclude each other.
        relations: between values.
        reserved: keys that are read elsewhere, and what to do about them.
        extra_schema: what JSON Schema can say of the relations.
    """

    noun: str
    fields: Mapping[str, Field]
    required: tuple[str, ...] = ()
    choices: tuple[tuple[str, ...], ...] = ()
    usual: str = ""
    apart: tuple[tuple[str, str], ...] = ()
    relations: tuple[Relation, ...] = ()
    reserved: Mapping[str, str] = field(default_factory=dict)
    extra_schema: dict[str, Any] = field(default_factory=dict)

    def column(self, values: list[Any]) -> dict[str, Any] | None:
        """The columns of each key, of n objects that all have the same keys."""
        if not set(map(type, values)) <= {dict} or len(set(map(frozenset, values))) != 1:
            return None
        return self.columns(values)

    def columns(self, objects: list[dict[str, Any]]) -> dict[str, Any] | None:
        """The columns of each key, of n objects that are known to have the same keys."""
        keys = objects[0]
        if any(True for _ in self._key_problems(keys)):
            return None
        columns = {}
        for key in keys:
            columns[key] = self.fields[key].kind.column(list(map(itemgetter(key), objects)))
            if columns[key] is None:
                return None
        return None if any(relation.is_broken(columns, keys) for relation in self.relations) else columns

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Not an object, wrong keys, wrong values; then the relations between right ones."""
        if not isinstance(value, dict):
            problems.add(place, f"{unlike(value, 'an object')}; give {self.noun} in braces", "scene-type")
            return
        if isinstance(value, RepeatedKeys):
            explain_repeated(value, place, problems)
        for key, message, code in self._key_problems(value):
            problems.add(place if key is None else key_place(place, key), message, code)
        columns = {key: self.fields[key].kind.column([value[key]]) for key in value if key in self.fields}
        for key, column in columns.items():
            if column is None:
                self.fields[key].kind.explain(value[key], key_place(place, key), problems)
        right = {key: column for key, column in columns.items() if column is not None}
        for relation in self.relations:
            if relation.is_broken(right, value):
                message = relation.message(*(value[key] for key in relation.keys))
                problems.add(key_place(place, relation.at), message, relation.code)

    def _key_problems(self, keys: Mapping[str, Any]) -> Iterator[_KeyProblem]:
        """All that is wrong with an object's keys."""
        for key in keys:
            if key in self.reserved:
                yield key, self.reserved[key], "scene-unsupported"
            elif key not in self.fields:
                near = get_close_matches(key[:60], self.fields, n=1)
                advice = f"did you mean {near[0]}?" if near else f"remove it; it takes {', '.join(self.fields)}"
                yield key, f"not a key of {self.noun}; {advice}", "scene-unknown-key"
        if not any(reserved in keys for reserved in self.reserved):
            yield from (self._missing(key) for key in self.required if key not in keys)
        for one, other in self.apart:
            if one in keys and other in keys:
                yield one, f"excludes {other}, which is given too; give one of them", "scene-conflict"
        if self.choices:
            yield from self._choice_problems(keys)

    def _choice_problems(self, keys: Mapping[str, Any]) -> Iterator[_KeyProblem]:
        touched = [choice for choice in self.choices if any(key in keys for key in choice)]
        wanted = one_of(tuple(" and ".join(choice) for choice in self.choices))
        if not touched:
            yield self.usual or None, f"{wanted} is missing; give one of them", "scene-missing"
        elif len(touched) > 1:
            first, second, *_ = (next(key for key in choice if key in keys) for choice in touched)
            yield second, f"excludes {first}, which is given too; give only {wanted}", "scene-conflict"
        else:
            yield from (self._missing(key) for key in touched[0] if key not in keys)

    def _missing(self, key: str) -> _KeyProblem:
        return key, f"missing; give {self.fields[key].about}", "scene-missing"

    def schema(self) -> dict[str, Any]:
        """An object without further properties."""
        properties = {}
        for key, each in self.fields.items():
            properties[key] = each.kind.schema() | {"description": each.about}
            if each.default is not None:
                properties[key]["default"] = each.default
        schema: dict[str, Any] = {"type": "object", "properties": properties, "additionalProperties": False}
        if self.required:
            schema["required"] = list(self.required)
        if self.choices:
            schema["oneOf"] = [_chosen(choice, self.choices) for choice in self.choices]
        if self.apart:
            schema["allOf"] = [{"not": {"required": list(pair)}} for pair in self.apart]
        return schema | self.extra_schema


def _chosen(choice: tuple[str, ...], choices: tuple[tuple[str, ...], ...]) -> dict[str, Any]:
    others = [key for other in choices if other is not choice for key in other]
    return {"required": list(choice), "not": {"anyOf": [{"required": [key]} for key in others]}}


def explain_repeated(value: RepeatedKeys, place: str, problems: Problems) -> None:
    """Note each key that an object gives more than once."""
    for key in value.repeated:
        problems.add(key_place(place, key), "given more than once; give it once", "scene-duplicate-key")
