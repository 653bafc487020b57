"""Sets: one entry that stands for many quadrics, each field giving one value for every element or one for all."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from conicoid.document.kinds import Kind
from conicoid.document.numeric import Ragged
from conicoid.document.problems import Problems
from conicoid.document.references import Unusable, row_as_json


class ElementKind(Kind, Protocol):
    """A kind whose values can come one for every element of a set."""

    def column(self, values: list[Any] | NDArray[Any]) -> Any:
        """As `Kind.column`; an array has no `fault`, and one row for each value."""

    def is_spread(self, value: Any) -> bool:
        """Whether a JSON value is a list of values: one level deeper than one value."""

    def fault(self, array: NDArray[Any]) -> str | None:
        """Why an array of one row per element cannot give the values: what it is, what it should be, the remedy."""


@dataclass(frozen=True)
class Spread:
    """What n sets give for one field.

    Attributes:
        column: all values, one set's after the other's, as the field's kind has them.
        lengths: (n,) int64, how many values each set gives, one for every element; -1 for one that all share.
    """

    column: Any
    lengths: NDArray[np.int64]

    @property
    def shared(self) -> NDArray[np.bool_]:
        """(n,) bool, which sets give one value that all elements share."""
        return self.lengths < 0

    def first_rows(self) -> NDArray[np.int64]:
        """(n,) int64, the row of `column` where each set's values begin."""
        sizes = np.abs(self.lengths)
        return np.cumsum(sizes) - sizes

    def expanded(self, counts: NDArray[np.int64]) -> Any:
        """One value for every element of every set, in the column's own form.

        Args:
            counts: (n,) int64, elements of each set; what `lengths` says where it is not -1.
        """
        if len(counts) == 1 and not self.shared[0]:
            return self.column
        if len(counts) == 1 and isinstance(self.column, np.ndarray):
            return np.broadcast_to(self.column[0], (int(counts[0]), *self.column.shape[1:]))
        rows = np.repeat(self.first_rows(), counts)
        rows += np.where(np.repeat(self.shared, counts), 0, places_within(counts))
        if isinstance(self.column, Ragged):
            return self.column.take(rows)
        return [self.column[row] for row in rows.tolist()] if isinstance(self.column, list) else self.column[rows]

    def split(self) -> list[Any]:
        """What each set gives, of a column that is a list: the shared value itself, or the list of its values."""
        stops = self.first_rows() + np.abs(self.lengths)
        slices = zip(self.lengths.tolist(), self.first_rows().tolist(), stops.tolist(), strict=True)
        return [self.column[start] if length < 0 else self.column[start:stop] for length, start, stop in slices]


def places_within(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """0 ... count - 1 for each count, one after the other."""
    starts = np.cumsum(counts) - counts
    return np.arange(int(counts.sum())) - np.repeat(starts, counts)


@dataclass(frozen=True)
class PerElement:
    """A value for each element of a set, in a list or an array, or one that all share."""

    kind: ElementKind

    def column(self, values: list[Any]) -> Spread | None:
        """The values of n sets; a set that refers to an array stands alone."""
        if len(values) == 1 and isinstance(values[0], np.ndarray):
            (array,) = values
            column = self.kind.column(array) if self.kind.fault(array) is None else None
            lengths = np.array([len(array)])
        else:
            spread = list(map(self.kind.is_spread, values))
            lengths = np.array([len(v) if many else -1 for v, many in zip(values, spread, strict=True)], np.int64)
            lists = [v if many else [v] for v, many in zip(values, spread, strict=True)]
            column = self.kind.column(lists[0] if len(lists) == 1 else list(chain.from_iterable(lists)))
        return None if column is None else Spread(column, lengths)

    def explain(self, value: Any, place: str, problems: Problems) -> None:
        """An array that is none of this field's, or each wrong element at its own place."""
        fault = self.kind.fault(value) if isinstance(value, np.ndarray) else None
        if isinstance(value, Unusable):
            problems.add(place, value.message, "scene-array")
        elif fault is not None:
            problems.add(place, fault, "scene-array")
        elif isinstance(value, np.ndarray) or self.kind.is_spread(value):
            for i in wrong(self.kind.column, value):
                self.kind.explain(row_as_json(value[i]), f"{place}[{i}]", problems)
        else:
            self.kind.explain(value, place, problems)

    def schema(self) -> dict[str, Any]:
        """A shared value, an array of values, or the name of an array; free text is never such a name."""
        one = self.kind.schema()
        return {"anyOf": [one, {"type": "array", "items": one}, {"type": "string", "pattern": "^@"}]}


def wrong(column: Callable[[Any], Any], values: Sequence[Any] | NDArray[Any]) -> Iterator[int]:
    """Positions of the wrong values, ascending, by bisection: a few passes find one among n right ones.

    `column` is a kind's: it answers None for a part of the values that holds a wrong one.
    """
    pending = [range(len(values))]
    while pending:
        part = pending.pop()
        if column(values[part.start : part.stop]) is not None:
            continue
        if len(part) == 1:
            yield part.start
        else:
            middle = len(part) // 2
            pending += [part[middle:], part[:middle]]
