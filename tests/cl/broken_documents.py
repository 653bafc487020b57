"""Hypothesis strategies for documents as bytes, most of which are broken somewhere."""

import json
from typing import Any

from hypothesis import strategies as st

from tests.cl.documents import documents
from tests.malformed import CASES

TEMPLATE = '{{"conicoid": 1, "quadrics": [{quadrics}], "camera": {{"width": 4, "height": 4, "fov_y": 40}}}}'
SPHERE = '{{"shape": "sphere", {}}}'

_SEEDS = [
    TEMPLATE.format(quadrics=SPHERE.format('"radius": 2, "clip": [[0, 0, 1, 0]], "id": 5')).encode(),
    *(case.body for case in CASES if len(case.body) < 1000),
]
_TOKENS = [
    b"", b"{", b"}", b"[", b"]", b",", b":", b'"', b"NaN", b"1e999", b"-0.0", b"null", b"true", b"\\u0041",
]  # fmt: skip
_JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)


@st.composite
def mutated_documents(draw: st.DrawFn) -> bytes:
    """Documents with some bytes replaced by others."""
    body = bytearray(draw(st.sampled_from(_SEEDS)))
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(body)))
        end = min(len(body), start + draw(st.integers(0, 6)))
        body[start:end] = draw(st.sampled_from(_TOKENS) | st.binary(max_size=3))
    return bytes(body)


@st.composite
def documents_with_junk(draw: st.DrawFn) -> bytes:
    """Documents with some values replaced by others."""
    document = draw(documents)
    for _ in range(draw(st.integers(1, 3))):
        node: Any = document
        while True:
            places = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not places:
                break
            place = draw(st.sampled_from(places))
            if isinstance(node[place], dict | list) and draw(st.booleans()):
                node = node[place]
                continue
            node[place] = draw(_JUNK)
            break
    return json.dumps(document).encode()
