"""Numeric kinds: numbers, lists of them, matrices, clip planes; a column is checked as one array."""

from dataclasses import dataclass
from itertools import chain
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from conicoid.document.json_text import Unreadable
from conicoid.document.problems import Problems, show, unlike
from conicoid.document.rules import Rule
from conicoid.scene import Floats

_BLOCK: Final = 1 << 14


@dataclass(frozen=True)
class Numbers:
    """A number, a list of `shape[0]` numbers, or a matrix in rows.

    Attributes:
        noun: what to give instead of a wrong value: `a positive radius`.
        shape: () for a number, (3,) for a list of three, (4, 4) for a matrix.
        whole: integers, written without fraction or exponent; else the nearest binary64 of any number.
        above, least, most, below: bounds of every entry, exclusive and inclusive.
        rules: on the value as a whole; applied in order once its entries are right.
    """

    noun: str
    shape: tuple[int, ...] = ()
    whole: bool = False
    above: float | None = None
    least: float | None = None
    most: float | None = None
    below: float | None = None
    rules: tuple[Rule, ...] = ()

    def column(self, values: list[Any] | NDArray[Any]) -> NDArray[Any] | None:
        """(n, *shape) float64 without -0, or int64."""
        array = self._entries(values)
        if array is None or not all(_holds(rule, array) for rule in self.rules):
            return None
        return array

    def is_spread(self, value: Any) -> bool:
        """A list whose first items nest one level deeper than one value; of an empty list there is no telling."""
        return _nests(value, len(self.shape))

    def fault(self, array: NDArray[Any]) -> str | None:
        """Anything but (n, *shape) of float64 or float32, of an unsigned type for integers."""
        if not _is_numeric(array, whole=self.whole):
            wanted = "an unsigned integer type" if self.whole else "float64 or float32"
            return f"an array of {array.dtype} is not one of {wanted}; convert it"
        if array.shape[1:] != self.shape:
            wanted = f"({', '.join(map(str, ('n', *self.shape)))}{'' if self.shape else ','})"
            return f"an array of shape {array.shape} is not one of {wanted}; give {self.noun} in each row"
        return None

    def _entries(self, values: list[Any] | NDArray[Any]) -> NDArray[Any] | None:
        if isinstance(values, np.ndarray):
            return self._converted(values)
        flat = values
        for size in self.shape:
            if not (set(map(type, flat)) <= {list} and set(map(len, flat)) <= {size}):
                return None
            flat = list(chain.from_iterable(flat))
        if not set(map(type, flat)) <= ({int} if self.whole else {int, float}):
            return None
        try:
            array = np.fromiter(flat, np.int64 if self.whole else np.float64, len(flat))
        except OverflowError:
            return None
        if not all(holds for holds, _ in self._bounds(array)):
            return None
        # Adding 0 turns -0 to +0: no image can tell them apart, and equal scenes get equal hashes.
        return (array + 0).reshape(len(values), *self.shape)

    def _converted(self, array: NDArray[Any]) -> NDArray[Any] | None:
        if not (np.isfinite(array).all() and all(holds for holds, _ in self._bounds(array))):
            return None
        return array.astype(np.int64) if self.whole else np.add(array, 0, dtype=np.float64)

    def _bounds(self, entries: Any) -> list[tuple[bool, str]]:
        """Whether all entries (an array or one number) are within each bound, and the bound in words."""
        bounds = []
        if self.above is not None:
            bounds.append((np.all(entries > self.above), f"> {self.above}"))
        if self.least is not None:
            bounds.append((np.all(entries >= self.least), f">= {self.least}"))
        if self.most is not None:
            bounds.append((np.all(entries <= self.most), f"<= {self.most}"))
        if self.below is not None:
            bounds.append((np.all(entries < self.below), f"< {self.below}"))
        return [(bool(holds), words) for holds, words in bounds]

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Wrong types, lengths and entries, each at its own place; then the first broken rule."""
        array = self._entries([value])
        if array is None:
            self._explain_entries(value, self.shape, place, problems)
            return
        for rule in self.rules:
            if not rule.holds(array).all():
                problems.add(f"{place}{rule.within}", rule.message(value), rule.code)
                return

    def _explain_entries(self, value: Any, shape: tuple[int, ...], place: str, problems: Problems) -> None:
        if not shape:
            self._explain_entry(value, place, problems)
        elif not isinstance(value, list):
            message = f"{unlike(value, f'a list of {shape[0]}')}; give {self.noun}"
            problems.add(place, message, "scene-type")
        elif len(value) != shape[0]:
            message = f"{show(value)} is not a list of {shape[0]}; give {self.noun}"
            problems.add(place, message, "scene-length")
        else:
            for i, inner in enumerate(value):
                self._explain_entries(inner, shape[1:], f"{place}[{i}]", problems)

    def _explain_entry(self, value: Any, place: str, problems: Problems) -> None:
        remedy = f"give {self.noun}"
        if isinstance(value, Unreadable):
            problems.add(place, f"{show(value)} is not a finite binary64 number; {remedy}", "scene-value")
        elif self.whole and isinstance(value, float):
            message = f"{show(value)} is not written as an integer; give it without fraction or exponent"
            problems.add(place, message, "scene-type")
        elif isinstance(value, bool) or not isinstance(value, int | float):
            wanted = "an integer" if self.whole else "a number"
            problems.add(place, f"{unlike(value, wanted)}; {remedy}", "scene-type")
        else:
            for holds, bound in self._bounds(value):
                if not holds:
                    problems.add(place, f"{show(value)} is not {bound}; {remedy}", "scene-value")

    def schema(self) -> dict[str, Any]:
        """A number with its bounds, or nested arrays of them of fixed length."""
        schema: dict[str, Any] = {"type": "integer" if self.whole else "number"}
        bounds = {
            "exclusiveMinimum": self.above,
            "minimum": self.least,
            "maximum": self.most,
            "exclusiveMaximum": self.below,
        }
        schema |= {name: bound for name, bound in bounds.items() if bound is not None}
        for size in reversed(self.shape):
            schema = {"type": "array", "items": schema, "minItems": size, "maxItems": size}
        for rule in self.rules:
            schema |= rule.schema
        return schema


def _holds(rule: Rule, array: NDArray[Any]) -> bool:
    """Whether all of a column's values satisfy a rule; in blocks, whose intermediate arrays stay in the cache."""
    return all(rule.holds(array[start : start + _BLOCK]).all() for start in range(0, len(array), _BLOCK))


def _nests(value: Any, depth: int) -> bool:
    """Whether a list's first items are lists, `depth` levels down or as far as they go."""
    for _ in range(depth):
        if type(value) is not list or not value:
            break
        value = value[0]
    return type(value) is list


def _is_numeric(array: NDArray[Any], *, whole: bool) -> bool:
    return array.dtype.kind == "u" if whole else array.dtype.kind == "f" and array.dtype.itemsize in (4, 8)


class Ragged(NamedTuple):
    """Lists of different lengths, one after the other.

    Attributes:
        rows: (sum of counts, k) float64.
        counts: (n,) int64, how many rows each value has.
    """

    rows: Floats
    counts: NDArray[np.int64]

    def take(self, values: NDArray[np.int64]) -> "Ragged":
        """The lists of those values, in that order; as often as they come."""
        counts = self.counts[values]
        starts = (np.cumsum(self.counts) - self.counts)[values]
        offsets = np.repeat(starts - (np.cumsum(counts) - counts), counts)
        return Ragged(self.rows[offsets + np.arange(len(offsets))], counts)


@dataclass(frozen=True)
class Rows:
    """A list of up to `most` lists of numbers."""

    row: Numbers
    most: int

    def column(self, values: list[Any] | NDArray[Any]) -> Ragged | None:
        """The rows of all values."""
        if isinstance(values, np.ndarray):
            rows = self.row.column(values.reshape(-1, *self.row.shape))
            many = 1 if values.ndim == 2 else values.shape[1]
            return None if rows is None else Ragged(rows, np.full(len(values), many))
        if not set(map(type, values)) <= {list}:
            return None
        counts = np.fromiter(map(len, values), np.int64, len(values))
        rows = self.row.column(list(chain.from_iterable(values)))
        return None if rows is None or (counts > self.most).any() else Ragged(rows, counts)

    def is_spread(self, value: Any) -> bool:
        """A list of lists of lists; an empty list is one value, without rows."""
        return bool(value) and _nests(value, 1 + len(self.row.shape))

    def fault(self, array: NDArray[Any]) -> str | None:
        """Anything but (n, *row) for one row per element, or (n, up to `most`, *row)."""
        if array.ndim == 2 + len(self.row.shape) and array.shape[1] <= self.most:
            array = array[:, 0] if array.shape[1] else array.reshape(0, *array.shape[2:])
        return self.row.fault(array)

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Not a list, too long, or a wrong row."""
        if not isinstance(value, list):
            message = f"{unlike(value, 'a list')}; give a list of {self.row.noun}"
            problems.add(place, message, "scene-type")
            return
        if len(value) > self.most:
            message = f"a list of {len(value)} is longer than {self.most}; give at most {self.most}"
            problems.add(place, message, "scene-length")
        for i, row in enumerate(value[: self.most]):
            self.row.explain(row, f"{place}[{i}]", problems)

    def schema(self) -> dict[str, Any]:
        """An array of rows."""
        return {"type": "array", "items": self.row.schema(), "maxItems": self.most}


@dataclass(frozen=True)
class NumbersOrInfinity:
    """A number, or the word `"inf"`, which JSON has no number for."""

    number: Numbers

    def column(self, values: list[Any]) -> Floats | None:
        """(n,) float64, inf for the word."""
        infinite = np.array([value == "inf" for value in values], dtype=bool)
        column = self.number.column([0 if value == "inf" else value for value in values])
        return None if column is None else np.where(infinite, np.inf, column)

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """Neither a number nor the word."""
        self.number.explain(value, place, problems)

    def schema(self) -> dict[str, Any]:
        """A number or a constant string."""
        return {"anyOf": [{"const": "inf"}, self.number.schema()]}
