"""Quadrics as bytes and back."""

import json
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from safetensors.numpy import load, save

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


def with_array(name: str, array: NDArray[Any]) -> bytes:
    """A whole file, as the library writes it, with one array in place of its own."""
    whole = quadrics_bytes(parse(EVERYTHING).resolve().quadrics)
    size = int.from_bytes(whole[:8], "little")
    return save(load(whole) | {name: array}, json.loads(whole[8 : 8 + size])["__metadata__"])


INT32 = st.one_of(st.integers(-(2**31), 2**31 - 1), st.integers(-1, 3), st.sampled_from([-(2**31), 2**31 - 1]))


@given(st.lists(INT32, min_size=2, max_size=2))
@example([2**31 - 1, -5])  # their difference is positive in int32
def test_starts_of_clips_that_are_taken_never_decrease(middle: list[int]) -> None:
    starts = [0, *middle, 2]
    if starts == sorted(starts):
        assert quadrics_from(with_array("clip_start", np.array(starts, np.int32))).clip_start.tolist() == starts
    else:
        with pytest.raises(QuadricsFileError):
            quadrics_from(with_array("clip_start", np.array(starts, np.int32)))


@pytest.mark.parametrize("name", [one.name for one in fields(Quadrics) if one.name not in ("name", "sets")])
def test_arrays_with_fewer_or_more_axes_are_refused(name: str) -> None:
    array = getattr(parse(EVERYTHING).resolve().quadrics, name)
    for wrong in (array.reshape(-1)[0].reshape(()), array[..., None], array[None]):
        with pytest.raises(QuadricsFileError):
            quadrics_from(with_array(name, np.ascontiguousarray(wrong).reshape(wrong.shape)))


@pytest.mark.parametrize("sets", [(KeptSet(0, 2), KeptSet(1, 3)), (KeptSet(1, 3), KeptSet(0, 1)), (KeptSet(2, 4),)])
def test_sets_out_of_order_or_bounds_are_refused(sets: tuple[KeptSet, ...]) -> None:
    quadrics = replace(parse(EVERYTHING).resolve().quadrics, sets=sets)
    with pytest.raises(QuadricsFileError):
        quadrics_from(quadrics_bytes(quadrics))


@pytest.mark.parametrize("data", [b"", b"\x00" * 8, b"\xff" * 100, b"\x02\x00\x00\x00\x00\x00\x00\x00{}"])
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(QuadricsFileError):
        quadrics_from(data)
