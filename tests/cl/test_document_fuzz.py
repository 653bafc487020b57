"""Whatever the bytes, parsing ends in a scene or in SceneError."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.document import parse
from conicoid.errors import SceneError
from tests.cl.documents import documents
from tests.malformed import CASES

TEMPLATE = '{{"conicoid": 1, "quadrics": [{quadrics}], "camera": {{"width": 4, "height": 4, "fov_y": 40}}}}'
SPHERE = '{{"shape": "sphere", {}}}'


@given(st.binary(max_size=200))
def test_random_bytes_are_refused_with_a_scene_error(body: bytes) -> None:
    with pytest.raises(SceneError):
        parse(body)


SEEDS = [
    TEMPLATE.format(quadrics=SPHERE.format('"radius": 2, "clip": [[0, 0, 1, 0]], "id": 5')).encode(),
    *(case.body for case in CASES if len(case.body) < 1000),
]


@given(st.data())
def test_mutated_documents_parse_or_raise_scene_error(data: st.DataObject) -> None:
    body = bytearray(data.draw(st.sampled_from(SEEDS)))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(body)))
        end = min(len(body), start + data.draw(st.integers(0, 6)))
        tokens = [
            b"",
            b"{",
            b"}",
            b"[",
            b"]",
            b",",
            b":",
            b'"',
            b"NaN",
            b"1e999",
            b"-0.0",
            b"null",
            b"true",
            b"\\u0041",
        ]
        body[start:end] = data.draw(st.sampled_from(tokens) | st.binary(max_size=3))
    parse_or_refuse(bytes(body))


junk = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


@given(st.data())
def test_documents_with_junk_in_them_parse_or_raise_scene_error(data: st.DataObject) -> None:
    document = data.draw(documents)
    for _ in range(data.draw(st.integers(1, 3))):
        node: Any = document
        while True:
            places = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not places:
                break
            place = data.draw(st.sampled_from(places))
            if isinstance(node[place], dict | list) and data.draw(st.booleans()):
                node = node[place]
                continue
            node[place] = data.draw(junk)
            break
    parse_or_refuse(json.dumps(document).encode())


def parse_or_refuse(body: bytes) -> None:
    """Parse and resolve; nothing but SceneError may come out, and it has something to say."""
    refusal = None
    try:
        parse(body).resolve()
    except SceneError as error:
        refusal = error
    if refusal is not None:
        assert refusal.problems
        assert all(problem.message.isprintable() for problem in refusal.problems)
        str(refusal).encode()


def test_values_nest_and_repeat_without_harm_to_the_process() -> None:
    deep = "[" * 900 + "]" * 900
    parse_or_refuse(TEMPLATE.format(quadrics=SPHERE.format(f'"center": {deep}')).encode())
    parse_or_refuse(TEMPLATE.format(quadrics=SPHERE.format(f'"name": {deep}')).encode())
    parse_or_refuse(("[" * 5000 + "]" * 5000).encode())
    parse_or_refuse(('{"a":' * 900 + "1" + "}" * 900).encode())
    many_keys = ", ".join(f'"k{i}": {i}' for i in range(20_000))
    parse_or_refuse(TEMPLATE.format(quadrics=SPHERE.format(many_keys)).encode())
