"""Factors of forms, and what lines across the image say of the planes that rays meet."""

from itertools import product

import pytest
from flint import fmpq, fmpz, fmpz_mat
from hypothesis import assume, given
from hypothesis import strategies as st

from conicoid.exact.planes import factors, plane_key
from conicoid.exact.rays import ExactRays
from tests.cl.exact_pixels import ORTHOGRAPHIC, PINHOLE
from tests.scenes import as_scene
from tests.scenes.catalogue import Document, document

small = st.integers(-9, 9)
plane = st.lists(small, min_size=4, max_size=4).filter(lambda row: any(row[:3]))
POSE = {"world_from_camera": [[0.6, 0, 0.8, 0.5], [0, 1, 0, -1], [-0.8, 0, 0.6, 2], [0, 0, 0, 1]]}


def symmetric(p: list[int], q: list[int], factor: int) -> fmpz_mat:
    """The form of factor p q, doubled."""
    return fmpz_mat([[factor * (p[i] * q[j] + p[j] * q[i]) for j in range(4)] for i in range(4)])


def diagonal(*terms: int) -> fmpz_mat:
    return fmpz_mat([[terms[i] if i == j else 0 for j in range(4)] for i in range(4)])


def key(row: list[int]) -> tuple[fmpz, ...]:
    return plane_key([fmpz(value) for value in row])


def rays(camera: Document) -> ExactRays:
    scene = as_scene(document([{"shape": "sphere"}], {**camera, **POSE}))
    return ExactRays(scene.camera, scene.output)


@given(plane, plane, st.sampled_from([-2, -1, 1, 3]))
def test_a_product_of_planes_has_these_factors(p: list[int], q: list[int], factor: int) -> None:
    form = symmetric(p, q, factor)
    side, planes = factors(form)
    assert {plane_key(row) for row in planes} == {key(p), key(q)}
    assert len(planes) == len({key(p), key(q)})
    # side times their product, or the square of the one, is the form but for a positive factor.
    first, second = planes[0], planes[-1]
    again = [[side * (first[i] * second[j] + first[j] * second[i]) for j in range(4)] for i in range(4)]
    i, j = next((i, j) for i, j in product(range(4), repeat=2) if form[i, j])
    scale = fmpq(again[i][j], form[i, j])
    assert scale > 0
    assert all(scale * form[i, j] == again[i][j] for i, j in product(range(4), repeat=2))


@given(plane, st.integers(-3, 3).filter(bool))
def test_a_linear_function_has_one_plane(p: list[int], factor: int) -> None:
    _, planes = factors(symmetric(p, [0, 0, 0, 1], factor))
    assert [plane_key(row) for row in planes] == [key(p)]


@pytest.mark.parametrize(
    "form",
    [diagonal(1, -2, 0, 0), diagonal(1, 1, 0, 0), diagonal(1, 1, -1, 0), diagonal(0, 0, 1, 1), diagonal(0, 0, 1, -2),
     diagonal(1, -1, 1, -1), diagonal(0, 0, 0, 3), fmpz_mat([[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]])],
    ids=["irrational", "a line", "a cone", "empty", "irrational and parallel", "a quadric", "a constant", "a saddle"],
)  # fmt: skip
def test_other_forms_have_no_planes(form: fmpz_mat) -> None:
    assert factors(form)[1] == []


@pytest.mark.parametrize("camera", [PINHOLE, ORTHOGRAPHIC], ids=["pinhole", "orthographic"])
@given(p=plane, q=plane, u=st.integers(0, 128), v=st.integers(0, 32))
def test_a_line_tells_on_which_side_a_plane_is_met(
    camera: Document, p: list[int], q: list[int], u: int, v: int
) -> None:
    view = rays(camera)
    seen, half_space = view.planes(fmpz_mat([p, q]))
    moving = seen.moving.at(fmpz(u), fmpz(v))
    offset, slope = (moving, seen.fixed) if view.orthographic else (seen.fixed, moving)
    assume(slope and seen.fixed and -offset / fmpq(slope) > 0)
    t = -offset / fmpq(slope)
    other = half_space.moving.at(fmpz(u), fmpz(v))
    value = other + half_space.fixed * t if view.orthographic else half_space.fixed + other * t
    line = half_space.keeps(seen).at(fmpz(u), fmpz(v))
    assert (line > 0) - (line < 0) == (value > 0) - (value < 0)


@pytest.mark.parametrize("camera", [PINHOLE, ORTHOGRAPHIC], ids=["pinhole", "orthographic"])
@given(p=plane, depth=st.integers(1, 5))
def test_beyond_a_depth_is_a_half_space_like_any_other(camera: Document, p: list[int], depth: int) -> None:
    view = rays(camera)
    (seen,) = view.planes(fmpz_mat([p]))
    u, v = fmpz(3), fmpz(7)
    moving = seen.moving.at(u, v)
    offset, slope = (moving, seen.fixed) if view.orthographic else (seen.fixed, moving)
    assume(slope and seen.fixed and -offset / fmpq(slope) > 0)
    line = view.depth_beyond(fmpq(depth)).keeps(seen).at(u, v)
    beyond = -offset / fmpq(slope) - depth
    assert (line > 0) - (line < 0) == (beyond > 0) - (beyond < 0)
