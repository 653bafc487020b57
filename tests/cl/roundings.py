"""Roundings counted along a kernel's own statements: what a bound of the kind n u Σ|terms| must allow for."""

import importlib.resources
import re
from collections.abc import Mapping
from fractions import Fraction
from math import frexp
from typing import Any

UNIT_ROUNDOFF = Fraction(1, 2**53)
_TYPES = "real|reals|double|double4|quadratic|linear|vector3"


class Counted:
    """A sum of products of symbols: by product, the sum of the coefficients' magnitudes and the most roundings.

    Operators round once each; products by powers of two and sums with zero do not.
    """

    def __init__(self, terms: Mapping[tuple[str, ...], tuple[Fraction, int]]) -> None:
        self.terms = dict(terms)

    @staticmethod
    def symbol(name: str, roundings: int = 0) -> "Counted":
        return Counted({(name,): (Fraction(1), roundings)})

    @property
    def roundings(self) -> int:
        """Of the term that passes through most."""
        return max(count for _, count in self.terms.values())

    def rounded(self) -> "Counted":
        return Counted({product: (size, count + 1) for product, (size, count) in self.terms.items()})

    def where(self, name: str) -> "Counted":
        """The terms that have this factor."""
        return Counted({product: term for product, term in self.terms.items() if name in product})

    def renamed(self, names: Mapping[str, str]) -> "Counted":
        """Every symbol by that which bounds its magnitude."""
        total = Counted({})
        for product, term in self.terms.items():
            total = total.plus(Counted({tuple(sorted(names.get(name, name) for name in product)): term}))
        return total

    def plus(self, other: "Counted") -> "Counted":
        """The exact sum."""
        terms = dict(self.terms)
        for product, (size, count) in other.terms.items():
            before, most = terms.get(product, (Fraction(0), 0))
            terms[product] = (before + size, max(most, count))
        return Counted(terms)

    def times(self, other: "Counted") -> "Counted":
        """The exact product."""
        total = Counted({})
        for first, (size, count) in self.terms.items():
            for second, (other_size, other_count) in other.terms.items():
                term = (size * other_size, count + other_count)
                total = total.plus(Counted({tuple(sorted(first + second)): term}))
        return total

    def __neg__(self) -> "Counted":
        return self

    def __add__(self, other: "Counted | float") -> "Counted":
        total = self.plus(_counted(other))
        return total.rounded() if self.terms and _counted(other).terms else total

    __radd__ = __sub__ = __add__
    __abs__ = __neg__

    def __mul__(self, other: "Counted | float") -> "Counted":
        product = self.times(_counted(other))
        return product if not isinstance(other, Counted) and frexp(other)[0] == 0.5 else product.rounded()

    __rmul__ = __mul__

    def __truediv__(self, other: float) -> "Counted":
        return self * (1 / other)

    def __rtruediv__(self, other: float) -> "Counted":
        (((name,), (_, count)),) = self.terms.items()
        assert other == 1
        return Counted({(f"1/{name}",): (Fraction(1), count + 1)})


def fma(a: Counted, b: Counted, c: Counted | float) -> Counted:
    return a.times(b).plus(_counted(c)).rounded()


def run(file: str, first: str, last: str, names: dict[str, Any]) -> Any:
    """Runs the assignments of a kernel's file from that which starts with `first` to that which starts with `last`.

    Args:
        names: what they use, and what they leave.
    Returns:
        What is returned, if anything is.
    """
    text = _kernel(file)
    start = text.index(first)
    text = text[start : text.index(";", text.index(last, start))]
    text = re.sub(r"//.*|^#.*", "", text, flags=re.MULTILINE)
    text = re.sub(rf"\((?:{_TYPES})\)", "", text).replace("->", ".")
    for statement in (" ".join(part.split()) for part in re.split("[;{}]", text)):
        if statement.startswith("return "):
            return eval(statement.removeprefix("return "), names)
        if " = " in statement or " += " in statement:
            # Several variables in one declaration are several assignments.
            exec(re.sub(r", (\w+ = )", r"; \1", re.sub(rf"^(?:const )?(?:{_TYPES}) ", "", statement)), names)
    return None


def constant(file: str, pattern: str) -> Fraction:
    """The number that a kernel has where the pattern has its group."""
    (found,) = set(re.findall(pattern, _kernel(file)))
    return Fraction(found)


def gamma(n: int) -> Fraction:
    """Bound of the relative error of n roundings, exact."""
    return n * UNIT_ROUNDOFF / (1 - n * UNIT_ROUNDOFF)


def _kernel(file: str) -> str:
    return (importlib.resources.files("conicoid") / "kernels" / file).read_text(encoding="utf-8")


def _counted(value: "Counted | float") -> Counted:
    if isinstance(value, Counted):
        return value
    return Counted({(): (Fraction(value), 0)} if value else {})
