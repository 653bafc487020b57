"""Problems of a document: how they are collected, and how places and values are written in them."""

import json
from typing import Any

from conicoid.document.json_text import Unreadable
from conicoid.errors import Problem, SceneError

MOST_PROBLEMS = 100
_LONGEST = 60  # characters of a document's own text in one message


class Problems:
    """What is wrong with one document, in the order of discovery; raises by itself when it has seen enough."""

    def __init__(self) -> None:
        self._found: list[Problem] = []

    def __len__(self) -> int:
        return len(self._found)

    def add(self, place: str, message: str, code: str) -> None:
        """Note one problem.

        Raises:
            SceneError: this is problem number `MOST_PROBLEMS`.
        """
        self._found.append(Problem(place, message, code))
        if len(self._found) == MOST_PROBLEMS:
            raise SceneError(self._found)

    def raise_any(self) -> None:
        """Raise SceneError with all problems noted, if there are any."""
        if self._found:
            raise SceneError(self._found)


def key_place(place: str, key: str) -> str:
    """Place of `key` in the object at `place`: `camera.width`, or `camera["my key"]` where a dot would mislead."""
    if key.isascii() and key.isidentifier() and len(key) <= _LONGEST:
        return f"{place}.{key}" if place else key
    return f"{place}[{quote(key)}]"


def quote(text: str) -> str:
    """Text as printable ASCII in double quotes, shortened."""
    shown = json.dumps(text[:_LONGEST])
    return shown if len(text) <= _LONGEST else f"{shown[:-1]}...{shown[-1]}"


def show(value: Any) -> str:
    """A JSON value as a message shows it: scalars as in JSON and shortened, containers by their kind only."""
    if isinstance(value, str):
        return quote(value)
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    shown = value.text if isinstance(value, Unreadable) else json.dumps(value)
    return shown if len(shown) <= _LONGEST else f"{shown[:_LONGEST]}..."


def show_numbers(values: list[Any]) -> str:
    """A list of numbers as a message shows it: all of them."""
    return f"[{', '.join(map(show, values))}]"


def unlike(value: Any, wanted: str) -> str:
    """What a value of the wrong type is and is not: `"1" is a string, not a number`."""
    return f"{show(value)} is a string, not {wanted}" if isinstance(value, str) else f"{show(value)} is not {wanted}"
