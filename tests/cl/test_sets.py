"""A set of quadrics is its quadrics, one after the other, whether its values come as JSON or as arrays."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from conicoid.canonical import canonical_bytes, scene_hash
from conicoid.document import parse
from conicoid.errors import LimitError, SceneError
from conicoid.scene import MOST_EXPANDED, KeptSet, Quadrics, Scene
from tests.cl.documents import Json, documents, documents_and_expansions
from tests.cl.test_canonical import assert_same

CAMERA: Json = {"width": 8, "height": 6, "fov_y": 40}
Arrays = dict[str, NDArray[Any]]


def resolved(document: Json, arrays: Arrays | None = None) -> Scene:
    return parse(json.dumps(document).encode(), arrays).resolve()


def quadrics(*entries: Json, **arrays: NDArray[Any]) -> Quadrics:
    return resolved({"conicoid": 1, "quadrics": list(entries), "camera": CAMERA}, arrays).quadrics


@contextmanager
def keeping_more_than(most: int) -> Iterator[None]:
    """Sets of more quadrics than this stay sets."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("conicoid.document.resolve.MOST_EXPANDED", most)
        yield


def in_arrays(document: Json) -> tuple[Json, Arrays]:
    """The same document with every list of a set's numbers as an array of the type that it needs."""
    arrays: Arrays = {}
    entries = []
    for i, entry in enumerate(document["quadrics"]):
        named = dict(entry)
        for key, value in entry.items() if "count" in entry else ():
            array = as_array(key, value, entry["count"])
            if array is not None:
                arrays[f"{key} of {i}"] = array
                named[key] = f"@{key} of {i}"
        entries.append(named)
    return document | {"quadrics": entries}, arrays


def as_array(key: str, value: Any, count: int) -> NDArray[Any] | None:
    """A field's values as an array; None where they are shared, or text, or of different lengths."""
    if key in ("name", "clip", "shape") or not isinstance(value, list) or count == 0:
        return None
    array: NDArray[Any] = np.array(value, {"id": np.uint32, "capped": np.bool_}.get(key, np.float64))
    whole = {"radius": 1, "id": 1, "capped": 1, "transform": 3, "matrix": 3}
    return array if array.ndim == whole.get(key, 2) else None


@given(documents_and_expansions())
def test_a_set_is_its_quadrics_one_after_the_other(pair: tuple[Json, Json]) -> None:
    scene, expanded = map(resolved, pair)
    assert_same(scene, expanded)
    assert canonical_bytes(scene) == canonical_bytes(expanded)


@given(documents)
def test_arrays_say_the_same_as_lists(document: Json) -> None:
    named, arrays = in_arrays(document)
    assert_same(resolved(named, arrays), resolved(document))


@given(documents_and_expansions(), st.integers(0, 3))
def test_a_set_that_is_kept_is_the_same_scene(pair: tuple[Json, Json], most: int) -> None:
    expanded = resolved(pair[1])
    with keeping_more_than(most):
        scene = resolved(pair[0])
        body = canonical_bytes(scene)
        again = parse(body).resolve()
        assert_same(again, scene)
        assert canonical_bytes(again) == body
    assert scene_hash(scene) == scene_hash(expanded)
    assert canonical_bytes(parse(body).resolve()) == canonical_bytes(expanded)


def test_a_list_is_one_value_for_each_and_anything_else_is_shared() -> None:
    entry = {
        "shape": "cylinder", "count": 2, "radius": [1, 2], "center": [[0, 0, 0], [1, 2, 3]], "z_range": [-1, 1],
        "capped": [True, False], "clip": [[0, 0, 1, 0]], "id": 7, "name": "twin",
    }  # fmt: skip
    two = quadrics(entry)
    assert two.radii.tolist() == [[1, 1, 1], [2, 2, 1]]
    assert two.world_from_object[:, :, 3].tolist() == [[0, 0, 0], [1, 2, 3]]
    assert two.z_range.tolist() == [[-1, 1], [-1, 1]]
    assert two.capped.tolist() == [True, False]
    assert (two.clip.tolist(), two.clip_start.tolist()) == ([[0, 0, 1, 0]] * 2, [0, 1, 2])
    assert two.id.tolist() == [7, 8]
    assert two.name == {0: "twin", 1: "twin"}


def test_sets_and_quadrics_keep_their_places_whatever_they_give() -> None:
    entries: list[Json] = [
        {"shape": "sphere", "center": [1, 0, 0]}, {"shape": "cone", "count": 2, "center": [[2, 0, 0], [3, 0, 0]]},
        {"shape": "sphere", "center": [4, 0, 0]}, {"shape": "cone", "count": 1, "center": [5, 0, 0], "radius": [2]},
        {"shape": "cone", "count": 2, "center": [[6, 0, 0], [7, 0, 0]]},
    ]  # fmt: skip
    scene = quadrics(*entries)
    assert scene.world_from_object[:, 0, 3].tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert scene.radii[:, 0].tolist() == [1, 1, 1, 1, 2, 1, 1]


def test_each_element_may_have_clips_of_its_own() -> None:
    clipped = quadrics({"shape": "sphere", "count": 3, "clip": [[], [[0, 0, 1, 0], [0, 1, 0, 0]], [[1, 0, 0, 0]]]})
    assert clipped.clip_start.tolist() == [0, 0, 2, 3]
    assert clipped.clip.tolist() == [[0, 0, 1, 0], [0, 1, 0, 0], [1, 0, 0, 0]]


@pytest.mark.parametrize("per_element", [0, 1, 2, 8])
def test_an_array_of_clips_has_as_many_for_each_element(per_element: int) -> None:
    planes = np.arange(3 * per_element * 4, dtype=np.float64).reshape(3, per_element, 4)
    clipped = quadrics({"shape": "sphere", "count": 3, "clip": "@planes"}, planes=planes)
    assert np.diff(clipped.clip_start).tolist() == [per_element] * 3
    assert clipped.clip.tolist() == planes.reshape(-1, 4).tolist()


def test_a_flat_array_of_clips_is_one_for_each_element() -> None:
    clipped = quadrics({"shape": "sphere", "count": 2, "clip": "@planes"}, planes=np.eye(4)[:2])
    assert clipped.clip_start.tolist() == [0, 1, 2]


def test_ids_that_are_not_given_are_positions_among_all_quadrics() -> None:
    entries: list[Json] = [
        {"shape": "sphere"}, {"shape": "cone", "count": 3}, {"shape": "plane"}, {"shape": "cone", "count": 2, "id": 4},
        {"shape": "cone", "count": 0}, {"shape": "sphere", "count": 2, "id": [9, 9]}, {"shape": "sphere"},
    ]  # fmt: skip
    assert quadrics(*entries).id.tolist() == [1, 2, 3, 4, 5, 4, 5, 9, 9, 10]


def test_the_last_of_consecutive_ids_may_be_the_largest() -> None:
    assert quadrics({"shape": "sphere", "count": 2, "id": 2**32 - 2}).id.tolist() == [2**32 - 2, 2**32 - 1]


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", ">f4"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_any_layout_of_an_array_gives_its_values(dtype: str, order: Any) -> None:
    center = np.array([[0.1, -0.0, 2], [3, 4, 5]]).astype(dtype, order)
    given = quadrics({"shape": "sphere", "count": 2, "center": "@center"}, center=center)
    assert given.world_from_object[:, :, 3].tobytes() == (center.astype(np.float64) + 0).tobytes()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.uint32, np.uint64])
def test_ids_come_in_any_unsigned_type(dtype: Any) -> None:
    given = quadrics({"shape": "sphere", "count": 2, "id": "@id"}, id=np.array([255, 1], dtype))
    assert given.id.tolist() == [255, 1]


def test_arrays_are_left_as_they_are() -> None:
    center = np.array([[-0.0, 1, 2]])
    center.setflags(write=False)
    given = quadrics({"shape": "sphere", "count": 1, "center": "@center"}, center=center)
    assert not np.signbit(given.world_from_object[0, 0, 3])
    assert np.signbit(center[0, 0])


def test_an_array_may_serve_several_sets() -> None:
    entries = [{"shape": "sphere", "count": 2, "radius": "@r"}, {"shape": "cone", "count": 2, "radius": "@r"}]
    assert quadrics(*entries, r=np.array([2.0, 3.0])).radii[:, 0].tolist() == [2, 3, 2, 3]


def test_a_name_is_free_text_also_where_it_looks_like_an_array() -> None:
    assert quadrics({"shape": "sphere", "count": 1, "name": "@home"}).name == {0: "@home"}


def test_a_set_of_ten_thousand_is_written_out_and_a_larger_one_is_not() -> None:
    def entries(count: int) -> list[Json]:
        scene = resolved({"conicoid": 1, "quadrics": [{"shape": "plane", "count": count}], "camera": CAMERA})
        written: list[Json] = json.loads(canonical_bytes(scene))["quadrics"]
        return written

    assert len(entries(MOST_EXPANDED)) == MOST_EXPANDED == 10_000
    (kept,) = entries(10_001)
    assert list(kept) == ["shape", "count", "transform", "id"]
    assert kept["count"] == len(kept["transform"]) == len(kept["id"]) == 10_001
    assert kept["id"][-1] == 10_001


def test_a_kept_set_in_full() -> None:
    sphere = {"shape": "sphere", "count": 2, "radius": 3, "id": 5, "z_range": [0, 1], "capped": [True, False]}
    form = {"shape": "quadric", "count": 2, "coefficients": [1, 0, 0, 0, 0, 0, 0, 0, 0, 0], "name": ["a", "b"]}
    clips = {"shape": "parallel_planes", "count": 2, "clip": [[[0, 0, 1, 0]], []], "radius": [1, 2], "name": "c"}
    entries = [{"shape": "plane"}, sphere, {"shape": "plane", "name": "x"}, form, clips]
    identity = np.eye(4).tolist()
    with keeping_more_than(1):
        scene = resolved({"conicoid": 1, "quadrics": entries, "camera": CAMERA})
    assert json.loads(canonical_bytes(scene))["quadrics"] == [
        {"shape": "plane", "transform": identity, "id": 1},
        {
            "shape": "sphere", "count": 2, "radius": [3.0, 3.0], "transform": [identity] * 2, "id": [5, 6],
            "z_range": [[0.0, 1.0]] * 2, "capped": [True, False],
        },
        {"shape": "plane", "transform": identity, "id": 4, "name": "x"},
        {
            "shape": "quadric", "count": 2, "matrix": [np.diag([1.0, 0, 0, 0]).tolist()] * 2,
            "transform": [identity] * 2, "id": [5, 6], "name": ["a", "b"],
        },
        {
            "shape": "parallel_planes", "count": 2, "radius": [1.0, 2.0], "transform": [identity] * 2, "id": [7, 8],
            "clip": [[[0.0, 0.0, 1.0, 0.0]], []], "name": "c",
        },
    ]  # fmt: skip
    assert scene.quadrics.sets == (KeptSet(1, 3), KeptSet(4, 6, ["a", "b"]), KeptSet(6, 8, "c"))


def test_more_quadrics_than_allowed_are_refused_before_their_values_are_looked_at() -> None:
    body = b'{"quadrics": [{"shape": "sphere"}, {"count": 9, "radius": [1, 2]}, {"count": -5}, {"count": true}, 0]}'
    with pytest.raises(LimitError) as caught:
        parse(body, most_quadrics=10)
    assert (caught.value.limit, caught.value.asked) == (10, 11)
    with pytest.raises(SceneError):
        parse(body, most_quadrics=11)


def test_positions_never_run_beyond_the_ids_there_are() -> None:
    many = {"shape": "sphere", "count": 2**32 - 1}
    with pytest.raises(LimitError):
        quadrics(many, {"shape": "sphere"})


def test_a_huge_count_costs_nothing_until_it_is_resolved() -> None:
    body = json.dumps({"conicoid": 1, "quadrics": [{"shape": "sphere", "count": 2**32 - 1}], "camera": CAMERA})
    assert parse(body.encode()).quadric_count == 2**32 - 1


def test_every_wrong_element_is_named_and_no_more_than_a_hundred() -> None:
    radius = np.ones(100_000)
    radius[[17, 99_999]] = -1, np.nan
    with pytest.raises(SceneError) as caught:
        quadrics({"shape": "sphere", "count": 100_000, "radius": "@r"}, r=radius)
    assert [str(problem) for problem in caught.value.problems] == [
        "quadrics[0].radius[17]: -1.0 is not > 0; give a positive radius [scene-value]",
        "quadrics[0].radius[99999]: NaN is not a finite binary64 number; give a positive radius [scene-value]",
    ]
    with pytest.raises(SceneError) as caught:
        quadrics({"shape": "sphere", "count": 100_000, "radius": "@r"}, r=np.zeros(100_000))
    assert len(caught.value.problems) == 100


@pytest.mark.parametrize(
    "radius", [np.array([1j]), np.array(["1"]), np.array([1.0], object), np.ones(1, np.longdouble)]
)
def test_a_library_user_is_told_what_an_array_is_not(radius: NDArray[Any]) -> None:
    with pytest.raises(SceneError, match="is not one of float64 or float32; convert it"):
        quadrics({"shape": "sphere", "count": 1, "radius": "@r"}, r=radius)
