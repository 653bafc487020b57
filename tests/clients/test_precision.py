"""Overriding the precision in a document's text changes that and nothing else."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid_client.precision import with_precision

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda children: st.lists(children, max_size=3) | st.dictionaries(st.text(), children, max_size=3),
    max_leaves=6,
)
OUTPUTS = st.dictionaries(st.text() | st.just("precision"), VALUES, max_size=3)
DOCUMENTS = st.dictionaries(st.text(), VALUES, max_size=3) | st.builds(
    lambda rest, output: {**rest, "output": output}, st.dictionaries(st.text(), VALUES, max_size=3), OUTPUTS
)


@given(
    document=DOCUMENTS.filter(lambda d: isinstance(d.get("output", {}), dict)),
    ascii_only=st.booleans(),
    indent=st.sampled_from([None, 0, 3]),
)
def test_override_equals_setting_the_key_in_the_parsed_document(
    document: dict[str, Any], ascii_only: bool, indent: int | None
) -> None:
    text = json.dumps(document, ensure_ascii=ascii_only, indent=indent).encode("utf-8", "surrogatepass")
    try:
        text.decode()
    except UnicodeDecodeError:  # a lone surrogate as raw bytes is not JSON: left for the service to report
        assert with_precision(text, "float32") == text
        return
    expected = {**document, "output": {**document.get("output", {}), "precision": "float32"}}
    assert json.loads(with_precision(text, "float32")) == expected


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            '{"quadrics":[NaN,1e999,1,1],"quadrics":0}',
            '{"output": {"precision": "P"}, "quadrics":[NaN,1e999,1,1],"quadrics":0}',
        ),
        ('{"output" : {"precision":"exact" , "x":1.50}}', '{"output" : {"precision":"P" , "x":1.50}}'),
        (" {\n} ", ' {"output": {"precision": "P"}} '),
        ('{"o\\u0075tput": {}}', '{"o\\u0075tput": {"precision": "P"}}'),
        ('{"long": %s}' % ("9" * 5000), '{"output": {"precision": "P"}, "long": %s}' % ("9" * 5000)),
    ],
)
def test_override_keeps_every_other_byte(before: str, after: str) -> None:
    assert with_precision(before.encode(), "P").decode() == after


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"[]",
        b"null",
        b"{",
        b'{"a" 1}',
        b'{"a": 1',
        b'{"a": 1,}',
        b"{1: 2}",
        b'{"output": 3}',
        b'{"output": {}, "output": {}}',
        b'{"output": {"precision": "exact", "precision": "exact"}}',
        b'{"a": ' + b"[" * 100_000,
        b"\xef\xbb\xbf{}",
        b'{"a": "\xff"}',
    ],
)
def test_text_that_cannot_be_edited_without_doubt_is_left_to_the_service(text: bytes) -> None:
    assert with_precision(text, "float32") == text
