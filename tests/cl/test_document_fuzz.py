"""Whatever the bytes, parsing ends in a scene or in SceneError. `make fuzz` tries 20,000 documents."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.document import parse
from conicoid.errors import SceneError
from tests.cl.broken_documents import SPHERE, TEMPLATE, documents_with_junk, mutated_documents


@given(st.binary(max_size=200))
def test_random_bytes_are_refused_with_a_scene_error(body: bytes) -> None:
    with pytest.raises(SceneError):
        parse(body)


@given(mutated_documents())
def test_mutated_documents_parse_or_raise_scene_error(body: bytes) -> None:
    parse_or_refuse(body)


@given(documents_with_junk())
def test_documents_with_junk_in_them_parse_or_raise_scene_error(body: bytes) -> None:
    parse_or_refuse(body)


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
