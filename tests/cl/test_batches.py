"""Documents with many cameras."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.canonical import camera_document, canonical_batch_bytes
from conicoid.document import parse, parse_batch
from conicoid.errors import LimitError, SceneError
from tests.cl.documents import cameras
from tests.malformed import BATCHES, Case

QUADRICS = [{"shape": "sphere", "radius": 2}]


def batch(views: object) -> bytes:
    return json.dumps({"conicoid": 1, "quadrics": QUADRICS, "cameras": views}).encode()


@given(st.lists(cameras(), min_size=1, max_size=8))
def test_frame_k_is_what_a_document_with_camera_k_shows(views: list[object]) -> None:
    read, output = parse_batch(batch(views)).views()
    for one, view in zip(read, views, strict=True):
        document = {"conicoid": 1, "quadrics": QUADRICS, "camera": view}
        camera, same_output = parse(json.dumps(document).encode()).view()
        assert camera_document(one) == camera_document(camera)
        assert output == same_output


@given(st.lists(cameras(), min_size=1, max_size=8))
def test_canonical_batch_is_its_own_canonical_form(views: list[object]) -> None:
    first = parse_batch(batch(views))
    body = canonical_batch_bytes(first.resolve_quadrics(), *first.views())
    again = parse_batch(body)
    assert again.is_list
    assert canonical_batch_bytes(again.resolve_quadrics(), *again.views()) == body


def test_one_camera_is_a_batch_of_one() -> None:
    body = json.dumps({"conicoid": 1, "quadrics": QUADRICS, "camera": {"width": 4, "height": 3, "fov_y": 40}}).encode()
    one = parse_batch(body)
    assert not one.is_list
    assert one.pixel_counts.tolist() == [12]
    assert len(one.views()[0]) == 1


def test_pixels_are_those_of_crops() -> None:
    view = {"width": 4, "height": 3, "fov_y": 40}
    views = [view, {**view, "crop": [1, 1, 3, 2]}, {**view, "width": 5, "projection": "orthographic"}]
    views[2] = {"projection": "orthographic", "width": 5, "height": 3, "view_height": 1}
    assert sorted(parse_batch(batch(views)).pixel_counts.tolist()) == [2, 12, 15]


def test_too_many_quadrics_are_refused_before_they_are_read() -> None:
    with pytest.raises(LimitError):
        parse_batch(batch([]), most_quadrics=0)


@pytest.mark.parametrize("case", BATCHES, ids=[case.name for case in BATCHES])
def test_a_malformed_batch_has_one_problem_at_its_place(case: Case) -> None:
    with pytest.raises(SceneError) as caught:
        parse_batch(case.body)
    assert [(problem.pointer, problem.code) for problem in caught.value.problems] == [(case.pointer, case.code)]


def test_who_takes_one_view_says_what_to_do_with_a_batch() -> None:
    with pytest.raises(SceneError, match="submit the batch as a job") as caught:
        parse(batch([{"width": 4, "height": 3, "fov_y": 40}]))
    assert [(problem.pointer, problem.code) for problem in caught.value.problems] == [("cameras", "scene-unsupported")]
