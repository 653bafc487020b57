"""The constants n of the bounds n u Σ|terms|, against the kernels' own statements.

n u / (1 - n u) bounds what n roundings do to a term (Higham 2002, section 3.1); what rounding takes off the bound
itself must be covered too.
"""

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from tests.cl.roundings import UNIT_ROUNDOFF, Counted, constant, fma, gamma, run

symbol = Counted.symbol
STORED = 1  # a coefficient rounded to binary64
EXACT = 0  # pixels and offsets between them


def allows(multiple: Fraction, roundings: int, own: int) -> bool:
    """Whether multiple x u, less what `own` roundings take off the bound, is enough for that many roundings."""
    return multiple * UNIT_ROUNDOFF * (1 - own * UNIT_ROUNDOFF) >= gamma(roundings)


def coefficients(count: int, roundings: int, name: str = "c") -> list[Counted]:
    return [symbol(f"{name}{k}", roundings) for k in range(count)]


def at_corner(value: Counted) -> Counted:
    """Where offsets of a pixel from a tile's middle are largest."""
    return value.renamed({"x": "half", "y": "half"})


def evaluated(kind: str, form: SimpleNamespace) -> Counted:
    """A polynomial at an exact offset, by the function of casting."""
    names = {kind[0]: form, "q": form, "x": symbol("x"), "y": symbol("y")}
    value: Counted = run("polynomials.h", "return " + EVALUATION[kind], "return", names)
    return value


EVALUATION = {"quadratic": "(q.uu", "linear": "l.u"}
MOVING = {"quadratic": ("q.uu = ", "q.one = ", "double x = fabs(du)", "q.error = "),
          "linear": ("l.u = ", "l.one = ", "l.error = ", "l.error = ")}  # fmt: skip
COEFFICIENTS = {"quadratic": 6, "linear": 3}


@pytest.mark.parametrize("kind", MOVING)
def test_moved_polynomials_round_no_more_often_than_their_bounds_allow(kind: str) -> None:
    first, last, first_of_error, last_of_error = MOVING[kind]
    form = SimpleNamespace()
    offset = {"du": symbol("du"), "dv": symbol("dv"), kind[0]: form}
    run("polynomials.h", first, last, {"c": coefficients(COEFFICIENTS[kind], STORED), **offset})
    value = at_corner(evaluated(kind, form))
    names = {
        "c": coefficients(COEFFICIENTS[kind], EXACT),
        "fabs": abs,
        "TILE": 2 * symbol("half"),
        "CHAIN": 1,
        **offset,
    }
    run("polynomials.h", first_of_error, last_of_error, names)
    magnitudes = form.error
    assert value.terms.keys() == magnitudes.terms.keys()
    assert all(size <= magnitudes.terms[product][0] for product, (size, _) in value.terms.items())
    chain = constant("polynomials.h", r"define CHAIN \((\d+)\.0 \* UNIT_ROUNDOFF")
    assert allows(chain, value.roundings, magnitudes.roundings)
    assert not allows(chain / 4, value.roundings, 0)


def simple_record() -> SimpleNamespace:
    """S and b of a simple record from moments and products that are binary64's, as set-up has them."""
    m = SimpleNamespace(
        l=[[symbol(f"l{p}{k}", STORED) for k in range(3)] for p in range(6)],
        ff=symbol("ff", STORED),
        fv=[symbol(f"fv{k}", STORED) for k in range(3)],
    )
    names: dict[str, Any] = {"m": m, "s": [0.0] * 6, "b": [0.0] * 3, "fma": fma, "sign": 1}
    for names["p"] in range(6):
        run("simple_forms.h", "double4 x = sign * m->l", "s[5] = fma(", names)
    names["per_ff"] = 1.0 / m.ff
    names["side"] = -names["per_ff"]
    for names["k"] in range(3):
        run("simple_forms.h", "b[k] = m->fv[k]", "b[k] = m->fv[k]", names)
    for names["k"] in range(6):
        run("simple_forms.h", "s[k] = (s[k] * per_ff)", "s[k] = (s[k] * per_ff)", names)
    return SimpleNamespace(s=names["s"], b=names["b"])


RAISING = 1
SQUARE_ROOT = 1
KEY, BAR_OF, LOW, COMPARISON = 1, 1, 1, 1  # offer.h: lead + root, bar - slop, key - slop, 2 best - bar


def cast_simple(record: SimpleNamespace) -> tuple[Counted, Counted]:
    """S and b at a pixel, (x, py) from the record's centre."""
    s = SimpleNamespace(**dict(zip(("uu", "uv", "vv", "u", "v", "one"), record.s, strict=True)))
    b = SimpleNamespace(**dict(zip(("u", "v", "one"), record.b, strict=True)))
    s.one = s.one.rounded()  # raised
    names = {"s": s, "b": b, "x": symbol("x"), "py": symbol("y")}
    run("simple.h", "real s_row = ", "real b_row = ", names)
    run("simple.h", "reals at = ", "reals lead = ", names)
    at, lead = names["at"], names["lead"]
    assert isinstance(at, Counted)
    assert isinstance(lead, Counted)
    return at, lead


def test_s_of_a_simple_record_rounds_no_more_often_than_its_bound_allows() -> None:
    at, _ = cast_simple(simple_record())
    multiple = constant("simple_forms.h", r"return \((\d+)\.0 \* UNIT_ROUNDOFF")
    # l_norm: a moment's three products and sums, squared and six of them summed, a root and a quotient twice; the rest.
    assert allows(multiple, at.roundings + RAISING, own=40)
    assert not allows(multiple / 4, at.roundings, own=0)


def test_the_terms_of_s_are_those_of_squares_of_moments() -> None:
    at, _ = cast_simple(simple_record())
    squares = Counted({})
    for p in range(6):
        moment = symbol(f"l{p}0").times(symbol("x")).plus(symbol(f"l{p}1").times(symbol("y"))).plus(symbol(f"l{p}2"))
        squares = squares.plus(moment.times(moment))
    per_ff = symbol("1/ff")
    expected = squares.times(per_ff).times(per_ff)
    assert {product: size for product, (size, _) in at.terms.items()} == {
        product: size for product, (size, _) in expected.terms.items()
    }


def test_a_key_rounds_no_more_often_than_its_bound_allows() -> None:
    _, lead = cast_simple(simple_record())
    afterwards = KEY + BAR_OF + LOW + COMPARISON
    of_b = constant("simple_forms.h", r"UNIT_ROUNDOFF \* \((\d+)\.0 \* b_size")
    of_root = constant("simple_forms.h", r"b_size \+ (\d+)\.0 \* l_norm")
    assert allows(of_b, lead.roundings + afterwards, own=40)
    assert allows(of_root, SQUARE_ROOT + afterwards, own=40)


# Rows of the camera's inverse, rounded, times a rotation R, |R'R - 1| <= 1e-6, in normals of the camera's space: four
# roundings, in products whose magnitudes are those of |R| in place of R, which lengthens a vector by sqrt(3) at most.
AXES = 7


@pytest.mark.parametrize("orthographic", [False, True])
def test_a_simple_gradient_rounds_no_more_often_than_its_bound_allows(*, orthographic: bool) -> None:
    axes = [[symbol(f"axis{j}", AXES) for _ in range(3)] for j in range(3)]
    principal = [symbol(name, STORED) for name in ("pu", "pv")]
    names: dict[str, Any] = {
        "r": SimpleNamespace(**vars(simple_record()), centre=[symbol("cu"), symbol("cv")]),
        "f": SimpleNamespace(axes=axes, principal=principal),
        "root": symbol("root", SQUARE_ROOT), "x": symbol("x"), "y": symbol("y"), "n": SimpleNamespace(),
    }  # fmt: skip
    run("simple.h", "real uv = ", "reals deeper = ", names)
    if not orthographic:
        run("simple.h", "deeper = (u * x", "deeper += ", names)
    run("simple.h", "n.x = ", "n.z = ", names)
    of_s = constant("simple_forms.h", r"return \((\d+)\.0 \* UNIT_ROUNDOFF") + constant(
        "simple_forms.h", r"s_error \+ (\d+)\.0 \* UNIT_ROUNDOFF"
    )
    of_b = constant("simple_forms.h", r"rounded = (\d+)\.0 \* UNIT_ROUNDOFF \* b_norm")
    of_third = constant("simple_forms.h", r"\(double4\)\((\d+)\.0 \* UNIT_ROUNDOFF\)")
    for component in vars(names["n"]).values():
        with_root = component.where("root")
        s_alone = Counted({p: term for p, term in component.terms.items() if p not in with_root.terms})
        third = Counted({p: term for p, term in with_root.terms.items() if not any(name[:2] == "fv" for name in p)})
        assert allows(of_s, s_alone.roundings, own=60)
        assert allows(of_b, with_root.roundings, own=60)
        assert bool(third.terms) == orthographic
        assert not orthographic or allows(of_third, third.roundings, own=60)


def test_two_places_round_no_more_often_than_their_bound_allows() -> None:
    leads = []
    for name in "pq":
        names: dict[str, Any] = {
            "p": SimpleNamespace(lead=coefficients(3, STORED, name)),
            "u": symbol("u"),
            "v": symbol("v"),
        }
        run("places.h", "double along = ", "double along = ", names)
        leads.append(run("places.h", "return along", "return along", names))
    difference = leads[1] - leads[0]
    # `size`: a product, five sums of magnitudes, and three more for those within a plane.
    assert allows(constant("places.h", r"> (\d+) \* UNIT_ROUNDOFF"), difference.roundings, own=9)
    assert not allows(constant("places.h", r"> (\d+) \* UNIT_ROUNDOFF") / 2, difference.roundings, own=0)


def test_a_ray_backwards_rounds_as_often_as_its_bound_counts() -> None:
    back = [coefficients(3, STORED, "back") for _ in range(3)]
    names: dict[str, Any] = {
        "f": SimpleNamespace(back=back),
        "u": symbol("u"),
        "v": symbol("v"),
        "n": SimpleNamespace(),
    }
    run("winners.h", "n.x = (real)f->back", "n.z = ", names)
    multiple = constant("winners.h", r"n\.error \+= (\d+) \* UNIT_ROUNDOFF")
    assert names["n"].x.roundings <= multiple
    # What the sum of magnitudes loses itself is in the 1.01 that n.error is multiplied with afterwards.
    assert allows(multiple * Fraction(101, 100), names["n"].x.roundings, own=9)
