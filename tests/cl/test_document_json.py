"""JSON is read strictly: every number to the nearest binary64, every key once, and everything wrong is reported."""

import contextlib
import gc
import json
import sys
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from conicoid.document import parse
from conicoid.document.json_text import RepeatedKeys, Unreadable, read_exact, read_fast
from conicoid.document.problems import MOST_PROBLEMS
from conicoid.errors import SceneError
from tests.cl.documents import documents

TEMPLATE = '{{"conicoid": 1, "quadrics": [{quadrics}], "camera": {{"width": 4, "height": 4, "fov_y": 40}}}}'
SPHERE = '{{"shape": "sphere", {}}}'


def center_x(literal: str) -> float:
    """The binary64 that a number of the document is read as."""
    body = TEMPLATE.format(quadrics=SPHERE.format(f'"center": [{literal}, 0, 0]'))
    return float(parse(body.encode()).resolve().quadrics.world_from_object[0, 0, 3])


literals = st.from_regex(r"-?(0|[1-9][0-9]{0,40})(\.[0-9]{1,40})?([eE][+-]?[0-9]{1,3})?", fullmatch=True)


@given(literals)
@example("0.1000000000000000055511151231257827021181583404541015625")
@example("9007199254740993")
@example("9007199254740993.00000000000000000000000000000000000000000000001")
@example("18446744073709551615")
@example("18446744073709551616")
@example("-99999999999999999999")
@example("2.4703282292062327e-324")
@example("2.4703282292062328e-324")
@example("1e-400")
@example("179769313486231570000000000000000000000e270")
@example("1" + "0" * 308)
def test_every_number_is_read_as_the_nearest_binary64(literal: str) -> None:
    exact = Fraction(Decimal(literal))
    try:
        nearest = exact.numerator / exact.denominator  # Python divides integers with correct rounding
    except OverflowError:
        with pytest.raises(SceneError):
            center_x(literal)
    else:
        assert center_x(literal) == nearest


@given(documents)
def test_both_readers_read_a_valid_document_alike(document: Any) -> None:
    body = json.dumps(document).encode()
    exact = read_exact(body)
    assert exact == document
    fast = read_fast(body)
    assert fast is None or as_floats(fast) == as_floats(exact)


def as_floats(value: Any) -> Any:
    """The value with each number as binary64: an integer beyond 64 bits may already be one."""
    if isinstance(value, dict):
        return {key: as_floats(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [as_floats(inner) for inner in value]
    return float(value) if isinstance(value, int) else value


def test_the_fast_reader_takes_plain_scenes() -> None:
    plain = [
        SPHERE.format('"radius": 2'),
        SPHERE.format('"name": "chain A: 12"'),
        SPHERE.format('"name": "tab\\t"'),
        SPHERE.format('"center": [1e5, -2, 0.5]'),
    ]
    body = TEMPLATE.format(quadrics=", ".join(plain)).encode()
    assert read_fast(body) is None  # a colon in a text beside an escape: either could hide a repeated key
    for quadric in plain:
        assert read_fast(TEMPLATE.format(quadrics=quadric).encode()) is not None


@pytest.mark.parametrize(
    "quadric",
    [
        '"radius": 1, "radius": 1',
        '"radius": 1, "r\\u0061dius": 1',
        '"name": "a", "name": "b"',
        '"name": "\\u003a", "name": "b"',
        '"name": "b", "name": "\\u003a"',
        '"name": "::", "name": ":"',
        '"name": {"a": 1, "a": 2}',
        '"name": [{"a": 1, "a": 2}]',
    ],
)
def test_no_repeated_key_passes_the_fast_reader(quadric: str) -> None:
    assert read_fast(TEMPLATE.format(quadrics=SPHERE.format(quadric)).encode()) is None


class Pairs(list[tuple[str, Any]]):
    """Keys and values to be written as one object, repeated keys and all."""


keys = st.sampled_from(["a", "b", ":", "\\", "quadrics", "name"])
scalars = st.sampled_from(["", "a", ":", "::", "\\", "\t", 0, None])
small = st.lists(st.tuples(keys, scalars), max_size=3).map(Pairs)
nested = st.lists(st.tuples(keys, scalars | small | st.lists(small, max_size=2)), max_size=4).map(Pairs)


def text_of(value: Any) -> str:
    if isinstance(value, Pairs):
        return "{" + ",".join(f"{json.dumps(key)}:{text_of(inner)}" for key, inner in value) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(text_of, value)) + "]"
    return json.dumps(value)


def repeats_a_key(value: Any) -> bool:
    if isinstance(value, dict):
        return isinstance(value, RepeatedKeys) or any(map(repeats_a_key, value.values()))
    return isinstance(value, list) and any(map(repeats_a_key, value))


@given(nested)
def test_the_fast_reader_never_vouches_for_a_repeated_key(pairs: Any) -> None:
    body = text_of(pairs).encode()
    if repeats_a_key(read_exact(body)):
        assert read_fast(body) is None


def test_syntax_errors_give_line_and_column() -> None:
    with pytest.raises(SceneError, match=r"^line 3, column 15: not JSON: expecting ',' delimiter; .* \[scene-json\]$"):
        parse(b'{"conicoid": 1,\n "quadrics": [],\n "camera": {} "output": {}}')
    with pytest.raises(SceneError, match=r"^line 2, byte 3: byte 0xff is not UTF-8; .* \[scene-json\]$"):
        parse(b'{\n "\xff": 1}')


def test_a_byte_order_mark_is_named() -> None:
    with pytest.raises(SceneError, match=r"^starts with a byte order mark; "):
        parse(b"\xef\xbb\xbf{}")


def test_all_problems_of_a_document_are_reported_at_once() -> None:
    body = b"""{"conicoid": 1, "quadrics": [
        {"shape": "sphere", "radius": -1, "center": [0, NaN, 0], "id": 0, "id": 1.0},
        {"shape": "cone", "colour": 1}, 5, {"shape": "sphere"}, {"shape": "ellipsoid", "radii": [1, "2", 0]}],
        "camera": {"width": 0, "fov_y": 200, "near": 2, "far": 1}, "output": {"channels": []}}"""
    with pytest.raises(SceneError) as caught:
        parse(body)
    assert [problem.pointer for problem in caught.value.problems] == [
        "quadrics[0].id",
        "quadrics[0].radius",
        "quadrics[0].center[1]",
        "quadrics[0].id",
        "quadrics[1].colour",
        "quadrics[2]",
        "quadrics[4].radii[1]",
        "quadrics[4].radii[2]",
        "camera.height",
        "camera.width",
        "camera.fov_y",
        "camera.far",
        "output.channels",
    ]
    assert str(caught.value).count("\n") == len(caught.value.problems) - 1


def test_no_more_than_a_hundred_problems_are_reported() -> None:
    body = TEMPLATE.format(quadrics=", ".join([SPHERE.format('"radius": 0')] * 5000)).encode()
    with pytest.raises(SceneError) as caught:
        parse(body)
    assert len(caught.value.problems) == MOST_PROBLEMS == 100
    assert caught.value.problems[-1].pointer == "quadrics[99].radius"


def test_the_order_of_keys_means_nothing() -> None:
    one = '{"shape": "sphere", "radius": 2, "center": [1, 2, 3]}'
    other = '{"center": [1, 2, 3], "radius": 2, "shape": "sphere"}'
    document = parse(TEMPLATE.format(quadrics=f"{one}, {other}").encode())
    assert len(document.quadrics) == 1
    assert document.quadric_count == 2


def test_long_integers_are_shortened_in_messages() -> None:
    long = "9" * 300
    for quadric in (
        f'"radius": -{long}',
        f'"z_range": [{long}, -{long}]',
        f'"transform": [{", ".join([f"[{long}, 0, 0, 0]"] * 4)}]',
    ):
        with pytest.raises(SceneError) as caught:
            parse(TEMPLATE.format(quadrics=SPHERE.format(quadric)).encode())
        assert len(caught.value.problems[0].message) < 300


@pytest.mark.parametrize("body", [b"{}", TEMPLATE.format(quadrics="").encode()])
def test_the_cycle_collector_is_left_as_it_was(body: bytes) -> None:
    for turn in (gc.disable, gc.enable):
        turn()
        before = gc.isenabled()
        with contextlib.suppress(SceneError):
            parse(body)
        assert gc.isenabled() is before


def test_integers_longer_than_python_converts_are_refused_by_name() -> None:
    digits = "9" * (sys.get_int_max_str_digits() + 1)
    with pytest.raises(SceneError, match=r"^quadrics\[0\]\.id: 9{60}\.\.\. is not a finite binary64 number; "):
        parse(TEMPLATE.format(quadrics=SPHERE.format(f'"id": {digits}')).encode())
    assert isinstance(read_exact(digits.encode()), Unreadable)


def test_a_document_that_does_not_fit_in_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(_: bytes) -> None:
        raise MemoryError

    monkeypatch.setattr("conicoid.document.document.read_fast", exhausted)
    with pytest.raises(SceneError, match=r"^does not fit in memory; .* \[scene-json\]$"):
        parse(b"{}")
