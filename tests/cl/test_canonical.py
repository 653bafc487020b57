"""The canonical form says all of a scene and nothing else, and the hash follows it."""

import dataclasses
import json

import numpy as np
import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.canonical import canonical_bytes, canonical_document, scene_hash
from conicoid.document import parse
from conicoid.scene import Scene
from tests.cl.documents import Json, documents

EVERYTHING: Json = {
    "conicoid": 1,
    "quadrics": [
        {"shape": "sphere", "radius": 2, "name": "ball"},
        {"shape": "parabolic_cylinder", "radius": 3, "id": 7},
        {"shape": "parallel_planes", "radius": 4, "clip": [[0, 0, 1, 0]]},
        {"shape": "cylinder", "radius": 5, "z_range": [-1, 1], "capped": True},
        {"shape": "quadric", "coefficients": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], "rotation": [0, 0, 2, 2]},
        {"shape": "plane", "center": [0, -0.0, 1]},
    ],
    "camera": {"width": 4, "height": 2, "fov_y": 90, "far": 10, "crop": [1, 0, 3, 2]},
    "output": {"background_depth": -0.0},
}


def resolved(document: Json) -> Scene:
    return parse(json.dumps(document).encode()).resolve()


def assert_same(one: Scene, other: Scene) -> None:
    """Every array and number of two scenes is the same to the last bit."""
    for part in ("quadrics", "camera", "output"):
        left, right = getattr(one, part), getattr(other, part)
        for field in dataclasses.fields(left):
            a, b = getattr(left, field.name), getattr(right, field.name)
            if isinstance(a, np.ndarray):
                assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes()), field.name
            else:
                assert repr(a) == repr(b), field.name


@given(documents)
def test_a_scene_survives_its_canonical_form_exactly(document: Json) -> None:
    scene = resolved(document)
    assert_same(parse(canonical_bytes(scene)).resolve(), scene)


@given(documents)
def test_the_canonical_form_is_its_own_canonical_form(document: Json) -> None:
    body = canonical_bytes(resolved(document))
    assert canonical_bytes(parse(body).resolve()) == body
    assert body.endswith(b"}\n")


@given(documents)
def test_the_hash_of_the_canonical_form_is_the_hash_of_the_document(document: Json) -> None:
    scene = resolved(document)
    assert scene_hash(parse(canonical_bytes(scene)).resolve()) == scene_hash(scene)


@given(documents)
def test_no_number_of_a_scene_is_minus_zero(document: Json) -> None:
    for quadric in document["quadrics"]:
        quadric.pop("name", None)
    numbers = canonical_bytes(resolved(document))
    assert b"-0.0," not in numbers
    assert b"-0.0]" not in numbers
    assert b"-0.0}" not in numbers


def test_the_canonical_document_in_full() -> None:
    identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    quarter = [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
    lifted = [*identity[:2], [0.0, 0.0, 1.0, 1.0], identity[3]]
    form = [[1.0, 2.0, 3.0, 4.0], [2.0, 5.0, 6.0, 7.0], [3.0, 6.0, 8.0, 9.0], [4.0, 7.0, 9.0, 10.0]]
    assert canonical_document(resolved(EVERYTHING)) == {
        "conicoid": 1,
        "quadrics": [
            {"shape": "sphere", "radius": 2.0, "transform": identity, "id": 1, "name": "ball"},
            {"shape": "parabolic_cylinder", "radius": 3.0, "transform": identity, "id": 7},
            {"shape": "parallel_planes", "radius": 4.0, "transform": identity, "id": 3, "clip": [[0.0, 0.0, 1.0, 0.0]]},
            {
                "shape": "cylinder",
                "radii": [5.0, 5.0],
                "transform": identity,
                "id": 4,
                "z_range": [-1.0, 1.0],
                "capped": True,
            },
            {"shape": "quadric", "matrix": form, "transform": quarter, "id": 5},
            {"shape": "plane", "transform": lifted, "id": 6},
        ],
        "camera": {
            "projection": "pinhole",
            "convention": "opengl",
            "width": 4,
            "height": 2,
            "fx": 1.0,
            "fy": 1.0,
            "cx": 2.0,
            "cy": 1.0,
            "world_from_camera": identity,
            "near": 0.0,
            "crop": [1, 0, 3, 2],
            "far": 10.0,
        },
        "output": {
            "channels": ["Z", "N"],
            "normal_space": "world",
            "normal_side": "facing",
            "background_depth": 0.0,
            "precision": "exact",
            "compression": "zip",
            "data_window": "full",
            "half_normals": False,
        },
    }


CHANGES: list[tuple[str, Json]] = [
    ("shape", {"quadrics": [{"shape": "cone"}]}),
    ("radius", {"quadrics": [{"shape": "sphere", "radius": 1.0000000000000002}]}),
    ("position", {"quadrics": [{"shape": "sphere", "center": [0, 5e-324, 0]}]}),
    ("id", {"quadrics": [{"shape": "sphere", "id": 2}]}),
    ("range", {"quadrics": [{"shape": "sphere", "z_range": [-2, 2]}]}),
    ("caps", {"quadrics": [{"shape": "sphere", "z_range": [-2, 2], "capped": True}]}),
    ("clip", {"quadrics": [{"shape": "sphere", "clip": [[0, 0, 0, 0]]}]}),
    ("one more", {"quadrics": [{"shape": "sphere"}, {"shape": "sphere"}]}),
    ("matrix", {"quadrics": [{"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, -1]}]}),
    ("another matrix", {"quadrics": [{"shape": "quadric", "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, -2]}]}),
    ("clip of the first", {"quadrics": [{"shape": "sphere", "clip": [[0, 0, 1, 0]]}, {"shape": "sphere"}]}),
    ("clip of the second", {"quadrics": [{"shape": "sphere"}, {"shape": "sphere", "clip": [[0, 0, 1, 0]]}]}),
    ("none", {"quadrics": []}),
    *[
        (key, {"camera": {"width": 4, "height": 4, "fx": 4, "fy": 4} | {key: value}})
        for key, value in {
            "width": 5,
            "height": 5,
            "fx": 5,
            "fy": 5,
            "cx": 1,
            "cy": 1,
            "near": 1,
            "far": 1,
            "crop": [0, 0, 4, 3],
            "projection": "orthographic",
            "convention": "opencv",
        }.items()
    ],
    *[
        (key, {"output": {key: value}})
        for key, value in {
            "channels": ["Z"],
            "normal_space": "camera",
            "normal_side": "outward",
            "background_depth": 0,
            "precision": "float64",
            "compression": "none",
            "data_window": "tight",
            "half_normals": True,
        }.items()
    ],
]
PLAIN: Json = {
    "conicoid": 1,
    "quadrics": [{"shape": "sphere"}],
    "camera": {"width": 4, "height": 4, "fx": 4, "fy": 4},
}


def test_whatever_can_change_the_image_changes_the_hash() -> None:
    hashes = [scene_hash(resolved(PLAIN | change)) for _, change in [("nothing", {}), *CHANGES]]
    assert len(set(hashes)) == len(hashes)


@pytest.mark.parametrize(
    "same",
    [
        {"quadrics": [{"shape": "sphere", "name": "a"}]},
        {"quadrics": [{"shape": "sphere", "radius": 1.0, "center": [0, -0.0, 0], "rotation": [0, -0.0, 0, -3]}]},
        {"quadrics": [{"shape": "sphere", "capped": False, "clip": []}]},
        {"camera": {"width": 4, "height": 4, "fx": 4.0, "fy": 4, "cy": 2, "near": -0.0, "crop": [0, 0, 4, 4]}},
        {"output": {"background_depth": "inf", "channels": ["Z", "N"]}},
    ],
)
def test_what_means_the_same_has_the_same_hash(same: Json) -> None:
    assert scene_hash(resolved(PLAIN | same)) == scene_hash(resolved(PLAIN))


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1))
def test_floats_are_written_in_shortest_round_trip_form(numbers: list[float]) -> None:
    for number, text in zip(numbers, orjson.dumps(numbers)[1:-1].decode().split(","), strict=True):
        assert float(text) == number
        digits = text.lower().split("e")[0].replace(".", "").replace("-", "").strip("0")
        shortest = repr(number).lower().split("e")[0].replace(".", "").replace("-", "").strip("0")
        assert digits == shortest
