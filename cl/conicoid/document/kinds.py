"""Kinds of values: each knows how to check a whole column of them, explain a wrong one, and describe itself.

A column holds the same key of many objects. `column` is the fast path, a few passes of C over all values at once; it
answers None if anything is wrong, and `explain` then says what, value by value. `schema` is the same in JSON Schema.
"""

from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from conicoid.document.problems import Problems, show, unlike


class Kind(Protocol):
    """A kind of JSON value."""

    def column(self, values: list[Any]) -> Any:
        """All values as one array or list in the same order, or None if any of them is wrong."""

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Note everything wrong with one value; at least one problem if `column([value])` is None."""

    def schema(self) -> dict[str, Any]:
        """The kind as JSON Schema 2020-12."""


@dataclass(frozen=True)
class Flag:
    """`true` or `false`."""

    def column(self, values: list[Any] | NDArray[np.bool_]) -> NDArray[np.bool_] | None:
        """(n,) bool."""
        if isinstance(values, np.ndarray):
            return values
        return np.array(values, dtype=bool) if set(map(type, values)) <= {bool} else None

    def is_spread(self, value: Any) -> bool:
        """A list."""
        return isinstance(value, list)

    def fault(self, array: NDArray[Any]) -> str | None:
        """Anything but (n,) bool."""
        if array.dtype == bool and array.ndim == 1:
            return None
        return f"an array of {array.dtype} and shape {array.shape} is not one of bool and shape (n,); convert it"

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Any other type is wrong."""
        problems.add(place, f"{unlike(value, 'a boolean')}; give true or false", "scene-type")

    def schema(self) -> dict[str, Any]:
        """A boolean."""
        return {"type": "boolean"}


@dataclass(frozen=True)
class Text:
    """Free text."""

    def column(self, values: list[Any] | NDArray[Any]) -> list[str] | None:
        """The n strings."""
        if isinstance(values, np.ndarray):
            return None
        return values if set(map(type, values)) <= {str} and _is_unicode("".join(values)) else None

    def is_spread(self, value: Any) -> bool:
        """A list."""
        return isinstance(value, list)

    def fault(self, array: NDArray[Any]) -> str | None:
        """Any array."""
        return f"an array of {array.dtype} is not text; give one text, or a list of them"

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Another type, or half a surrogate pair, which is no character and cannot be written as UTF-8."""
        if isinstance(value, str):
            problems.add(place, f"{show(value)} holds half a surrogate pair; give whole characters", "scene-value")
        else:
            problems.add(place, f"{unlike(value, 'a string')}; give text", "scene-type")

    def schema(self) -> dict[str, Any]:
        """A string."""
        return {"type": "string"}


def _is_unicode(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


@dataclass(frozen=True)
class Word:
    """One of a few words."""

    words: tuple[str, ...]

    def column(self, values: list[Any]) -> list[str] | None:
        """The n strings."""
        return values if set(map(type, values)) <= {str} and set(values) <= set(self.words) else None

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Another type or another word."""
        if isinstance(value, str):
            near = get_close_matches(value[:60], self.words, n=1)
            advice = f"did you mean {near[0]}?" if near else f"give {one_of(self.words)}"
            problems.add(place, f"{show(value)} is not known here; {advice}", "scene-value")
        else:
            message = f"{unlike(value, 'a string')}; give {one_of(self.words)}"
            problems.add(place, message, "scene-type")

    def schema(self) -> dict[str, Any]:
        """An enumeration of strings."""
        return {"type": "string", "enum": list(self.words)}


@dataclass(frozen=True)
class Words:
    """A list of different words, at least one."""

    words: tuple[str, ...]

    def column(self, values: list[Any]) -> list[tuple[str, ...]] | None:
        """One tuple per list."""
        return [tuple(value) for value in values] if all(map(self._is_valid, values)) else None

    def _is_valid(self, value: Any) -> bool:
        if type(value) is not list or not value or Word(self.words).column(value) is None:
            return False
        return len(set(value)) == len(value)

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Not a list, empty, a wrong word, or a word given before."""
        if not isinstance(value, list):
            message = f"{unlike(value, 'a list')}; give a list of {one_of(self.words)}"
            problems.add(place, message, "scene-type")
            return
        if not value:
            problems.add(place, f"the list is empty; give at least one of {', '.join(self.words)}", "scene-length")
        seen = set()
        for i, word in enumerate(value):
            if Word(self.words).column([word]) is None:
                Word(self.words).explain(word, f"{place}[{i}]", problems)
            elif word in seen:
                problems.add(f"{place}[{i}]", f"{show(word)} is given twice; give it once", "scene-value")
            else:
                seen.add(word)

    def schema(self) -> dict[str, Any]:
        """An array of different strings."""
        return {"type": "array", "items": Word(self.words).schema(), "minItems": 1, "uniqueItems": True}


def one_of(words: tuple[str, ...]) -> str:
    """`a`, `a or b`, `a, b or c`."""
    return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))
