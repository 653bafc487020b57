"""Overriding `output.precision` in a scene's JSON text without re-writing the rest of it.

The service reads a scene strictly: duplicate keys, NaN and numbers are judged as they are written. Parsing and
dumping the document here would hide all that, so the text is edited in place, and text that cannot be edited
without doubt is left alone for the service to report.
"""

import json
from typing import NamedTuple

# Numbers stay text: only the extents of values matter here, and str() takes any number of digits.
_DECODER = json.JSONDecoder(parse_float=str, parse_int=str, parse_constant=str)


class _Member(NamedTuple):
    key: str
    start: int
    end: int


def with_precision(scene: bytes, precision: str) -> bytes:
    """The same JSON text with `output.precision` set; every other byte is kept.

    Text that is not a JSON object, or that says `output` or `precision` twice, comes back unchanged: the service
    rejects it, and says why better than this could.
    """
    try:
        return _edit(scene.decode(), json.dumps(precision)).encode()
    except (ValueError, RecursionError):
        return scene


def _edit(text: str, value: str) -> str:
    document = _skip_space(text, 0)
    outputs = [m for m in _members(text, document) if m.key == "output"]
    if not outputs:
        return _insert(text, document, f'"output": {{"precision": {value}}}')
    if len(outputs) > 1 or text[outputs[0].start] != "{":
        return text
    output = outputs[0].start
    precisions = [m for m in _members(text, output) if m.key == "precision"]
    if not precisions:
        return _insert(text, output, f'"precision": {value}')
    if len(precisions) > 1:
        return text
    return text[: precisions[0].start] + value + text[precisions[0].end :]


def _insert(text: str, start: int, member: str) -> str:
    """Put a first member into the object at `start`."""
    first = _skip_space(text, start + 1)
    comma = "" if text[first] == "}" else ", "
    return text[: start + 1] + member + comma + text[first:]


def _members(text: str, start: int) -> list[_Member]:
    """Keys of the JSON object at `start`, each with the extent of its value.

    Raises:
        ValueError: there is no well-formed object.
    """
    members: list[_Member] = []
    at = _after(text, start, "{")
    if text.startswith("}", at):
        return members
    while True:
        if not text.startswith('"', at):
            raise ValueError(f"expected a key at character {at}")
        key, at = _DECODER.raw_decode(text, at)
        value_start = _after(text, _skip_space(text, at), ":")
        _, value_end = _DECODER.raw_decode(text, value_start)
        members.append(_Member(key, value_start, value_end))
        at = _skip_space(text, value_end)
        if text.startswith("}", at):
            return members
        at = _after(text, at, ",")


def _after(text: str, at: int, mark: str) -> int:
    """Where the next token starts after `mark`, which must be at `at`."""
    if not text.startswith(mark, at):
        raise ValueError(f"expected {mark} at character {at}")
    return _skip_space(text, at + len(mark))


def _skip_space(text: str, at: int) -> int:
    while text.startswith((" ", "\t", "\n", "\r"), at):
        at += 1
    return at
