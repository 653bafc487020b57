"""What a document means: parameters, placements, extents and defaults as arrays."""

import json
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from conicoid.document import Document, parse, parse_batch
from conicoid.document.determinant import determinant_sign
from conicoid.document.resolve import rotation_matrices
from conicoid.scene import Floats, Output, Quadrics
from conicoid.shapes import SHAPES
from tests.cl.rounded import add, divide, multiply, scaled, subtract

CODES = {shape.name: shape.code for shape in SHAPES}


def document(quadrics: list[Any], **camera: Any) -> Document:
    whole = {"conicoid": 1, "quadrics": quadrics, "camera": {"width": 8, "height": 6, "fov_y": 40} | camera}
    return parse(json.dumps(whole).encode())


def resolved(*quadrics: Any) -> Quadrics:
    return document(list(quadrics)).resolve().quadrics


def test_an_empty_list_of_quadrics_is_a_scene() -> None:
    quadrics = resolved()
    assert len(quadrics) == 0
    assert quadrics.clip_start.tolist() == [0]


@pytest.mark.parametrize("shape", [shape.name for shape in SHAPES if shape.name != "quadric"])
def test_a_shape_alone_stands_upright_at_the_origin_with_unit_radii(shape: str) -> None:
    quadrics = resolved({"shape": shape})
    assert quadrics.shape.tolist() == [CODES[shape]]
    assert quadrics.radii.tolist() == [[1, 1, 1]]
    assert quadrics.world_from_object.tolist() == np.eye(4)[None, :3].tolist()
    assert quadrics.id.tolist() == [1]
    assert quadrics.z_range.tolist() == [[-np.inf, np.inf]]
    assert quadrics.capped.tolist() == [False]
    assert quadrics.matrix_row.tolist() == [-1]


def test_a_radius_is_every_radius_that_its_shape_has() -> None:
    radii = {
        "sphere": [5, 5, 5],
        "cylinder": [5, 5, 1],
        "cone": [5, 5, 1],
        "paraboloid": [5, 5, 1],
        "parabolic_cylinder": [5, 1, 1],
        "parallel_planes": [1, 1, 5],
    }
    assert sorted(radii) == sorted(shape.name for shape in SHAPES if shape.radius)
    assert resolved(*({"shape": shape, "radius": 5} for shape in radii)).radii.tolist() == list(radii.values())


def test_radii_stand_in_their_order() -> None:
    for shape in SHAPES:
        if shape.radii > 1:
            given_radii = [2, 3, 4][: shape.radii]
            expected = [*given_radii, *[1] * (3 - shape.radii)]
            assert resolved({"shape": shape.name, "radii": given_radii}).radii.tolist() == [expected]


@given(st.lists(st.integers(-99, 99), min_size=10, max_size=10).filter(any), st.tuples(*[st.integers(-9, 9)] * 3))
def test_coefficients_and_their_matrix_have_the_same_f(coefficients: list[int], point: tuple[int, int, int]) -> None:
    a, b, c, d, e, f, g, h, i, j = coefficients
    x, y, z = point
    value = a * x * x + 2 * b * x * y + 2 * c * x * z + 2 * d * x + e * y * y + 2 * f * y * z + 2 * g * y
    value += h * z * z + 2 * i * z + j
    matrix = resolved({"shape": "quadric", "coefficients": coefficients}).matrix[0]
    position = np.array([x, y, z, 1.0])
    assert position @ matrix @ position == value
    again = resolved({"shape": "quadric", "matrix": matrix.tolist()})
    assert again.matrix.tolist() == [matrix.tolist()]


def test_quadrics_keep_their_order_whatever_they_give() -> None:
    half_spaces = [[0, 0, 1, float(k)] for k in range(9)]
    form = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1]]
    quadrics = resolved(
        {"shape": "quadric", "coefficients": [2] * 10, "clip": half_spaces[:2]},
        {"shape": "sphere", "radius": 2, "name": "b"},
        {"shape": "quadric", "matrix": form, "clip": []},
        {"radius": 3, "shape": "sphere", "clip": half_spaces[2:5], "name": "d"},
        {"shape": "cone", "z_range": [0, 1], "capped": True, "id": 77},
        {"shape": "quadric", "coefficients": [5] * 10, "z_range": [2, 2]},
        {"shape": "sphere", "radius": 4, "clip": half_spaces[5:], "center": [1, 2, 3]},
    )
    names = ["quadric", "sphere", "quadric", "sphere", "cone", "quadric", "sphere"]
    assert quadrics.shape.tolist() == [CODES[name] for name in names]
    assert quadrics.radii[:, 0].tolist() == [1, 2, 1, 3, 1, 1, 4]
    assert quadrics.matrix_row.tolist() == [0, -1, 1, -1, -1, 2, -1]
    assert quadrics.matrix[:, 0, 0].tolist() == [2, 1, 5]
    assert quadrics.clip[:, 3].tolist() == list(range(9))
    assert quadrics.clip_start.tolist() == [0, 2, 2, 2, 5, 5, 5, 9]
    assert quadrics.id.tolist() == [1, 2, 3, 4, 77, 6, 7]
    assert quadrics.capped.tolist() == [False] * 4 + [True] + [False] * 2
    assert quadrics.z_range[[4, 5]].tolist() == [[0, 1], [2, 2]]
    assert quadrics.name == {1: "b", 3: "d"}
    assert quadrics.world_from_object[6, :, 3].tolist() == [1, 2, 3]


def test_arrays_have_the_types_of_a_scene() -> None:
    quadrics = resolved({"shape": "quadric", "coefficients": [1] * 10, "clip": [[0, 0, 1, 0]]}, {"shape": "sphere"})
    types = {name: array.dtype.name for name, array in vars(quadrics).items() if isinstance(array, np.ndarray)}
    assert types == {
        "shape": "uint8",
        "radii": "float64",
        "matrix_row": "int32",
        "matrix": "float64",
        "world_from_object": "float64",
        "id": "uint32",
        "z_range": "float64",
        "capped": "bool",
        "clip": "float64",
        "clip_start": "int32",
    }


def test_a_transform_is_taken_as_it_is() -> None:
    transform = [[0.1, 2, 1e300, -5], [0, 1e-320, 7, 1e-5], [3, 0, 0.3, 9], [0, 0, 0, 1]]
    quadrics = resolved({"shape": "plane", "transform": transform})
    assert quadrics.world_from_object[0].tolist() == transform[:3]


quaternions = st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=4, max_size=4).filter(any)


def rotation_by_the_documented_steps(quaternion: list[float]) -> list[list[float]]:
    """docs/scene.md, each operation rounded from its exact result."""
    x, y, z, w = scaled(quaternion)
    xx, yy, zz, ww = (multiply(part, part) for part in (x, y, z, w))
    length2 = add(add(xx, yy), add(zz, ww))

    def diagonal(p: float, q: float, r: float) -> float:
        """((p + ww) - (q + r)) / ((p + ww) + (q + r))."""
        return divide(subtract(add(p, ww), add(q, r)), add(add(p, ww), add(q, r)))

    def twice(p: float) -> float:
        return divide(multiply(2, p), length2)

    xy, xz, yz = multiply(x, y), multiply(x, z), multiply(y, z)
    xw, yw, zw = multiply(x, w), multiply(y, w), multiply(z, w)
    return [
        [diagonal(xx, yy, zz), twice(subtract(xy, zw)), twice(add(xz, yw))],
        [twice(add(xy, zw)), diagonal(yy, xx, zz), twice(subtract(yz, xw))],
        [twice(subtract(xz, yw)), twice(add(yz, xw)), diagonal(zz, xx, yy)],
    ]


@given(quaternions)
@example([5e-324, 0, 0, 0])
@example([1.7976931348623157e308] * 4)
@example([5e-324, 1.7976931348623157e308, 1, -1])
def test_a_rotation_follows_the_documented_steps_to_the_last_bit(quaternion: list[float]) -> None:
    quadrics = resolved({"shape": "sphere", "rotation": quaternion})
    assert quadrics.world_from_object[0, :, :3].tolist() == rotation_by_the_documented_steps(quaternion)


@given(quaternions)
def test_a_rotation_is_that_of_the_exact_quaternion(quaternion: list[float]) -> None:
    x, y, z, w = (Fraction(part) for part in quaternion)
    n = x * x + y * y + z * z + w * w
    exact = [
        [(x * x + w * w - y * y - z * z) / n, 2 * (x * y - z * w) / n, 2 * (x * z + y * w) / n],
        [2 * (x * y + z * w) / n, (y * y + w * w - x * x - z * z) / n, 2 * (y * z - x * w) / n],
        [2 * (x * z - y * w) / n, 2 * (y * z + x * w) / n, (z * z + w * w - x * x - y * y) / n],
    ]
    computed = rotation_matrices(np.array([quaternion]))[0].tolist()
    # Products, two sums, the squared length (two sums of squares) and the division: at most 7 roundings on any path,
    # each of a number below n in magnitude: 7u of 1, and 8u to have the second-order terms too.
    bound = Fraction(8, 2**53)
    assert all(abs(Fraction(computed[i][j]) - exact[i][j]) <= bound for i in range(3) for j in range(3))


@pytest.mark.parametrize("length", [1, 0.7071, 3, 1e-320, 1e200])
def test_quarter_turns_are_exact(length: float) -> None:
    about_y = [0, length, 0, length]
    assert rotation_matrices(np.array([about_y])).tolist() == [[[0, 0, 1], [0, 1, 0], [-1, 0, 0]]]
    half_about_x = [length, 0, 0, 0]
    assert rotation_matrices(np.array([half_about_x])).tolist() == [[[1, 0, 0], [0, -1, 0], [0, 0, -1]]]
    circle_of_axes = [length] * 4
    assert rotation_matrices(np.array([circle_of_axes])).tolist() == [[[0, 0, 1], [1, 0, 0], [0, 1, 0]]]


def test_one_quadric_is_placed_as_among_a_thousand() -> None:
    # A loop over vector lanes and its remainder must round alike.
    random = np.random.default_rng(5)
    quaternion = random.normal(size=(1003, 4))
    together = rotation_matrices(quaternion)
    alone = np.concatenate([rotation_matrices(quaternion[k : k + 1]) for k in range(len(quaternion))])
    assert together.tobytes() == alone.tobytes()


entries = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from([0.0, 1.0, 0.1, 0.2, 0.3, 1e-320, 1e300])


def exact_sign(matrix: Floats) -> int:
    (a, b, c), (d, e, f), (g, h, i) = ([Fraction(entry) for entry in row] for row in matrix.tolist())
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return (determinant > 0) - (determinant < 0)


@given(st.lists(entries, min_size=9, max_size=9), st.sampled_from([None, (0, 1), (0, 2), (1, 2)]))
def test_the_sign_of_a_determinant_is_exact(values: list[float], same: tuple[int, int] | None) -> None:
    matrix = np.array(values).reshape(3, 3)
    if same:
        matrix[same[0]] = matrix[same[1]]
    assert determinant_sign(matrix[None]).tolist() == [exact_sign(matrix)]


def test_the_sign_of_a_determinant_is_exact_where_rounding_errs() -> None:
    random = np.random.default_rng(1)
    rows = np.round(random.uniform(-1, 1, (4000, 2, 3)), 1)
    # The third row is the rounded sum of the others: exactly singular or off by a rounding error.
    matrices = np.concatenate([rows, rows.sum(axis=1, keepdims=True)], axis=1)
    signs = [exact_sign(matrix) for matrix in matrices]
    assert determinant_sign(matrices).tolist() == signs
    assert {-1, 0, 1} == set(signs)
    naive = np.sign(np.linalg.det(matrices)).astype(int).tolist()
    assert naive != signs


def test_a_transform_that_only_rounding_makes_singular_is_taken() -> None:
    linear = [[0.4, 0.8, -0.2], [0.6, -0.1, 0.9], [1.4, 1.5, 0.5]]  # det is -4e-17, and 0 in binary64 arithmetic
    transform = [[*row, 0] for row in linear] + [[0, 0, 0, 1]]
    assert len(resolved({"shape": "sphere", "transform": transform})) == 1


def test_counts_are_known_before_anything_is_resolved() -> None:
    three = [{"shape": "sphere"}, {"shape": "cone"}, {"shape": "sphere"}]
    assert document(three).quadric_count == 3
    cameras: list[dict[str, Any]] = [
        {"width": 8, "height": 6},
        {"width": 8, "height": 6, "crop": [1, 2, 4, 6]},
        {"width": 65536, "height": 65536},
    ]
    batch = {"conicoid": 1, "quadrics": three, "cameras": [{**camera, "fov_y": 40} for camera in cameras]}
    counts = parse_batch(json.dumps(batch).encode()).pixel_counts
    assert sorted(counts.tolist()) == [12, 48, 2**32]


def test_an_output_left_out_is_the_default_output() -> None:
    body = b'{"conicoid": 1, "quadrics": [], "camera": {"width": 1, "height": 1, "fov_y": 1}, "output": {}}'
    assert parse(body).resolve().output == Output()
    assert document([]).resolve().output == Output()


def test_output_words_arrive() -> None:
    output = {
        "channels": ["id", "A", "P", "ZBack", "T"],
        "normal_space": "camera",
        "normal_side": "outward",
        "background_depth": 10000000000,
        "precision": "float32",
        "compression": "piz",
        "data_window": "tight",
        "half_normals": True,
    }
    body = {"conicoid": 1, "quadrics": [], "camera": {"width": 1, "height": 1, "fov_y": 1}, "output": output}
    resolved_output = vars(parse(json.dumps(body).encode()).resolve().output)
    assert resolved_output == output | {"channels": tuple(output["channels"])}  # type: ignore[arg-type]
    assert type(resolved_output["background_depth"]) is float
    assert type(resolved_output["half_normals"]) is bool
