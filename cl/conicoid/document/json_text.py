"""Strict JSON: bytes to Python values, exactly as written or with the place of what is wrong.

Two readers. `read_fast` is orjson plus a proof that no key is repeated; it answers None whenever it cannot vouch for
the text, right or wrong. `read_exact` is the standard library's parser with hooks that keep what the first one loses:
repeated keys, numbers beyond binary64, integers of any size, the line and column of a mistake. Both give every number
as the nearest binary64 or as an exact integer.
"""

import codecs
import json
from collections import Counter
from typing import Any, Final

import numpy as np
import orjson

from conicoid.errors import Problem, SceneError

_MOST_DIGITS = 309  # of an integer that binary64 can hold: 2^1024 has 309


class Unreadable:
    """A number in the text that no binary64 can stand for: NaN, Infinity, 1e999."""

    def __init__(self, text: str) -> None:
        self.text: Final = text


class RepeatedKeys(dict[str, Any]):
    """An object that gives some keys more than once; holds the last value of each."""

    def __init__(self, pairs: list[tuple[str, Any]]) -> None:
        super().__init__(pairs)
        self.repeated: Final = [key for key, count in Counter(key for key, _ in pairs).items() if count > 1]


def read_fast(body: bytes) -> Any:
    """The value of a JSON text if orjson takes it and no object of a scene repeats a key, else None."""
    try:
        tree = orjson.loads(body)
    except (orjson.JSONDecodeError, RecursionError):
        return None
    # Each key has one colon after it, so the text holds at least as many colons as keys, the repeated ones that
    # orjson dropped included: where it holds only as many as there are keys left, none was dropped.
    spare = np.count_nonzero(np.frombuffer(body, np.uint8) == ord(":")) - _keys(tree)
    if spare and b"\\" not in body:  # without escapes every colon of a string is one of the text
        spare -= _colons_in_quadrics(tree)
    return None if spare else tree


def _keys(tree: Any) -> int:
    """Keys of the objects where a scene has objects: nested in objects, or in lists of nothing but objects."""
    keys, pending = 0, [tree]
    while pending:
        value = pending.pop()
        if isinstance(value, dict):
            keys += len(value)
            pending += [inner for inner in value.values() if isinstance(inner, dict | list)]
        elif isinstance(value, list) and set(map(type, value)) == {dict}:
            keys += sum(map(len, value))
    return keys


def _colons_in_quadrics(tree: Any) -> int:
    quadrics = tree.get("quadrics") if isinstance(tree, dict) else None
    if not isinstance(quadrics, list):
        return 0
    objects = (quadric for quadric in quadrics if isinstance(quadric, dict))
    return sum(value.count(":") for quadric in objects for value in quadric.values() if isinstance(value, str))


def read_exact(body: bytes) -> Any:
    """The value of a JSON text, with `Unreadable` and `RepeatedKeys` where they stand in it.

    Raises:
        SceneError: the text is not JSON; the message has its line and column.
    """
    if body.startswith(codecs.BOM_UTF8):
        raise _not_json("starts with a byte order mark; save it as UTF-8 without one")
    try:
        text = body.decode()
    except UnicodeDecodeError as error:
        before = body[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        message = f"line {line}, byte {column}: byte 0x{body[error.start]:02x} is not UTF-8; save the text as UTF-8"
        raise _not_json(message) from None
    try:
        return _EXACT.decode(text)
    except json.JSONDecodeError as error:
        rule = error.msg.removesuffix(" at").removesuffix(" starting")
        rule = f"{rule[:1].lower()}{rule[1:]}"
        raise _not_json(f"line {error.lineno}, column {error.colno}: not JSON: {rule}; correct the text") from None
    except RecursionError:
        raise _not_json("nested too deeply; a scene document nests at most five levels") from None


def _not_json(message: str) -> SceneError:
    return SceneError([Problem("", message, "scene-json")])


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    plain = dict(pairs)
    return plain if len(plain) == len(pairs) else RepeatedKeys(pairs)


def _float(text: str) -> float | Unreadable:
    value = float(text)
    return Unreadable(text) if value in (float("inf"), float("-inf")) else value


def _integer(text: str) -> int | Unreadable:
    if len(text.lstrip("-")) > _MOST_DIGITS:
        return Unreadable(text)
    value = int(text)
    try:
        float(value)
    except OverflowError:
        return Unreadable(text)
    return value


_EXACT = json.JSONDecoder(object_pairs_hook=_object, parse_float=_float, parse_int=_integer, parse_constant=Unreadable)
