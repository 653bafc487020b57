"""Quadrics as bytes and back."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.canonical import quadrics_hash
from conicoid.document import parse
from conicoid.errors import QuadricsFileError
from conicoid.quadrics_file import quadrics_bytes, quadrics_from
from conicoid.scene import KeptSet, Quadrics
from tests.cl.documents import documents

EVERYTHING = json.dumps(
    {
        "conicoid": 1,
        "quadrics": [
            {"shape": "sphere", "name": "a ball", "clip": [[0, 0, 1, 0], [0, 1, 0, 0]]},
            {"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, -1]},
            {"shape": "cylinder", "z_range": [0, 1], "capped": True, "name": "\u00e9\u0000"},
        ],
        "camera": {"width": 4, "height": 3, "fov_y": 40},
    }
).encode()


def assert_same(one: Quadrics, other: Quadrics) -> None:
    for name, value in vars(one).items():
        if isinstance(value, np.ndarray):
            assert getattr(other, name).dtype == value.dtype
            np.testing.assert_array_equal(getattr(other, name), value)
        else:
            assert getattr(other, name) == value


@given(documents)
def test_bytes_give_the_same_quadrics_back(document: object) -> None:
    quadrics = parse(json.dumps(document).encode()).resolve().quadrics
    again = quadrics_from(quadrics_bytes(quadrics))
    assert_same(again, quadrics)
    assert quadrics_hash(again) == quadrics_hash(quadrics)


def test_sets_keep_their_names() -> None:
    quadrics = parse(EVERYTHING).resolve().quadrics
    quadrics = Quadrics(**{**vars(quadrics), "sets": (KeptSet(0, 1, ["x"]), KeptSet(1, 2), KeptSet(2, 3, "y"))})
    assert_same(quadrics_from(quadrics_bytes(quadrics)), quadrics)


@given(st.data())
def test_damaged_bytes_are_refused_or_lead_nowhere_out_of_their_arrays(data: st.DataObject) -> None:
    whole = bytearray(quadrics_bytes(parse(EVERYTHING).resolve().quadrics))
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    cut = bytes(whole[: data.draw(st.integers(0, len(whole)))]) if data.draw(st.booleans()) else bytes(whole)
    try:
        quadrics = quadrics_from(cut)
    except QuadricsFileError:
        return
    assert (quadrics.matrix_row < len(quadrics.matrix)).all()
    assert quadrics.clip_start[-1] == len(quadrics.clip)
    assert all(index < len(quadrics) for index in quadrics.name)


@pytest.mark.parametrize("data", [b"", b"\x00" * 8, b"\xff" * 100, b"\x02\x00\x00\x00\x00\x00\x00\x00{}"])
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(QuadricsFileError):
        quadrics_from(data)
