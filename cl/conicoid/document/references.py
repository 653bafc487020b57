"""`"@name"` in a set: the field's values are an array that came beside the document."""

from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.document.json_text import Unreadable
from conicoid.document.problems import Problems, key_place, quote
from conicoid.errors import LimitError

Arrays = Mapping[str, NDArray[Any]]

_MARK: Final = "@"
_NEVER_ARRAYS: Final = frozenset({"shape", "count", "name"})
_MOST_SHOWN: Final = 10


class Unusable:
    """What stands for a reference that gives no values; the message says why."""

    def __init__(self, message: str) -> None:
        self.message: Final = message


def refer(tree: Any, arrays: Arrays, most_quadrics: int) -> set[str]:
    """Put arrays where the sets of a document name them, `Unusable` where they give no value for each element.

    Returns:
        The names that the document used.

    Raises:
        LimitError: the document has more than `most_quadrics`; none of their values has been looked at.
    """
    quadrics = tree.get("quadrics") if isinstance(tree, dict) else None
    entries = quadrics if isinstance(quadrics, list) else []
    sets = [entry for entry in entries if isinstance(entry, dict) and "count" in entry]
    _check_count(len(entries) - len(sets), [entry["count"] for entry in sets], most_quadrics)
    used = set()
    for entry in sets:
        for key, value in entry.items():
            if isinstance(value, str) and value.startswith(_MARK) and key not in _NEVER_ARRAYS:
                name = value.removeprefix(_MARK)
                used.add(name)
                entry[key] = _values(name, entry["count"], arrays)
    return used


def _check_count(single: int, counts: list[Any], most: int) -> None:
    asked = single + sum(count for count in counts if type(count) is int and count > 0)
    if asked > most:
        raise LimitError("quadrics", most, asked)


def _values(name: str, count: Any, arrays: Arrays) -> NDArray[Any] | Unusable:
    array = arrays.get(name)
    if array is None:
        there = f"there are {_shown(arrays)}" if arrays else "none came with the document"
        return Unusable(f"{quote(_MARK + name)} names no array, {there}; send the array, or give the values here")
    if array.ndim == 0 or (type(count) is int and len(array) != count):
        return Unusable(
            f"the array {quote(name)} of shape {array.shape} has not one row for each of {count}; "
            "give as many rows as count says"
        )
    return array


def _shown(names: Iterable[str]) -> str:
    shown = [quote(name) for name in sorted(names)]
    return ", ".join(shown[:_MOST_SHOWN]) + (", ..." if len(shown) > _MOST_SHOWN else "")


def explain_unused(names: Iterable[str], problems: Problems) -> None:
    """Note arrays that no set of the document uses."""
    for name in sorted(names):
        message = f"no set uses this array; name it {quote(_MARK + name)} in an entry with count, or leave it out"
        problems.add(key_place("arrays", name), message, "scene-array")


def row_as_json(row: Any) -> Any:
    """One element of an array as the JSON value that would say the same."""
    if isinstance(row, np.ndarray | np.generic):
        return row_as_json(row.tolist())
    if isinstance(row, list):
        return [row_as_json(inner) for inner in row]
    if isinstance(row, float) and not np.isfinite(row):
        return Unreadable("NaN" if np.isnan(row) else f"{'-' if row < 0 else ''}Infinity")
    return row
