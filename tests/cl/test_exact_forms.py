"""Exact polynomials and roots against f itself, evaluated in fractions at points of the ray."""

from fractions import Fraction

import numpy as np
import pytest
from flint import fmpz

from conicoid.exact import CAP_HIGH, CAP_LOW, SURFACE, ExactScene, RationalPolynomial
from conicoid.scene import Scene
from conicoid.shapes import SHAPES
from tests.cl.exact_pixels import ORTHOGRAPHIC, PINHOLE, exact_scene
from tests.scenes import CATALOGUE, Document, as_scene

Point = list[Fraction]

SCENES = [
    "crowd", "overlapping_balls", "back_of_a_cap", "cans_end_to_end", "nested_shells",
    "one_plane_pinhole", "paraboloid_along_its_axis", "rays_along_rulings",
]  # fmt: skip
PIXELS = [(0, 0), (12, 8), (7, 3), (23, 15)]


def ray_point(scene: Scene, i: int, j: int, t: Fraction) -> Point:
    """The contract's ray, in the world."""
    camera = scene.camera
    x = (Fraction(2 * i + 1, 2) - Fraction(camera.cx)) / Fraction(camera.fx)
    y = -(Fraction(2 * j + 1, 2) - Fraction(camera.cy)) / Fraction(camera.fy)
    local = [x, y, -t] if camera.projection == "orthographic" else [t * x, t * y, -t]
    pose = [[Fraction(value) for value in row] for row in camera.world_from_camera.tolist()]
    return [sum((pose[k][m] * local[m] for m in range(3)), pose[k][3]) for k in range(3)]


def in_object(scene: Scene, index: int, world: Point) -> Point:
    """The world point in object space, by Cramer's rule."""
    rows = [[Fraction(value) for value in row] for row in scene.quadrics.world_from_object[index].tolist()]
    columns = [[row[k] for row in rows] for k in range(3)]
    right = [world[k] - rows[k][3] for k in range(3)]

    def determinant(p: Point, q: Point, r: Point) -> Fraction:
        return sum((p[k] * (q[k - 2] * r[k - 1] - q[k - 1] * r[k - 2]) for k in range(3)), Fraction(0))

    whole = determinant(columns[0], columns[1], columns[2])
    replaced = [[right if k == m else columns[k] for k in range(3)] for m in range(3)]
    return [determinant(p, q, r) / whole for p, q, r in replaced]


def f(scene: Scene, index: int, world: Point) -> Fraction:
    """The scene document's f."""
    quadrics = scene.quadrics
    point = in_object(scene, index, world)
    row = int(quadrics.matrix_row[index])
    if row >= 0:
        full = [*point, Fraction(1)]
        matrix = quadrics.matrix[row].tolist()
        return sum((Fraction(matrix[k][m]) * full[k] * full[m] for k in range(4) for m in range(4)), Fraction(0))
    shape, radii = SHAPES[int(quadrics.shape[index])], quadrics.radii[index].tolist()
    squares = (s * (x / Fraction(r)) ** 2 for s, x, r in zip(shape.squares, point, radii, strict=True))
    return sum(squares, shape.linear_z * point[2] + shape.constant)


def value(polynomial: RationalPolynomial, i: int, j: int) -> Fraction:
    """At the centre of a pixel, whose doubled coordinates are integers."""
    whole = polynomial.whole.doubled().at(fmpz(2 * i + 1), fmpz(2 * j + 1))
    return Fraction(int(whole), 4 * int(polynomial.over))


@pytest.mark.parametrize("name", [*SCENES, "saddle_along_its_axis"])
def test_polynomials_are_f_and_the_extent_along_the_ray(name: str) -> None:
    scene = as_scene(CATALOGUE[name].document)
    exact = ExactScene(scene)
    for index in range(len(scene.quadrics)):
        forms = exact.forms(index)
        radius = Fraction(float(scene.quadrics.radii[index, 2]))
        for i, j in PIXELS:
            a, b, c, s = (value(form, i, j) for form in (forms.a, forms.b, forms.c, forms.s))
            height = value(forms.height, i, j)
            assert s == b * b - a * c
            for t in (Fraction(0), Fraction(1), Fraction(-7, 3)):
                assert a * t * t + 2 * b * t + c == f(scene, index, ray_point(scene, i, j, t))
            for level, plane, cap in zip(scene.quadrics.z_range[index].tolist(), forms.range, forms.cap, strict=False):
                z = in_object(scene, index, ray_point(scene, i, j, Fraction(2)))[2]
                assert value(plane, i, j) + 2 * height == (z - Fraction(level)) / radius
                if height:
                    meeting = ray_point(scene, i, j, -value(plane, i, j) / height)
                    assert value(cap, i, j) == f(scene, index, meeting) * height**2


@pytest.mark.parametrize("name", SCENES)
def test_the_surface_lies_within_half_a_unit_of_the_reported_depth(name: str) -> None:
    """Between the two rounding boundaries f changes sign, or touches zero."""
    scene = as_scene(CATALOGUE[name].document)
    exact = ExactScene(scene)
    seen = 0
    for i in range(0, scene.camera.width, 5):
        for j in range(1, scene.camera.height, 4):
            pixel = exact.pixel(i, j, range(len(scene.quadrics)))
            if pixel is None or pixel.kind != SURFACE:
                continue
            depth = np.float32(pixel.z)
            ends = [
                (Fraction(pixel.z) + Fraction(float(np.nextafter(depth, np.float32(to))))) / 2 for to in (0, np.inf)
            ]
            below, above = (f(scene, pixel.quadric, ray_point(scene, i, j, end)) for end in ends)
            assert below * above <= 0
            seen += 1
    assert seen


@pytest.mark.parametrize("name", SCENES)
def test_moving_the_centre_of_a_polynomial_keeps_its_values(name: str) -> None:
    exact = exact_of(name)
    forms = exact.forms(0)
    moved = forms.about(12, -5)
    for before, after in zip(
        (forms.a, forms.b, forms.s, forms.height), (moved.a, moved.b, moved.s, moved.height), strict=True
    ):
        assert value(before, 20, 3) == value(after, 20 - 12, 3 + 5)


def exact_of(name: str) -> ExactScene:
    return ExactScene(as_scene(CATALOGUE[name].document))


@pytest.mark.parametrize("exponent", [0, 37, -1040])
def test_coefficients_are_rounded_once_whatever_they_are_scaled_by(exponent: int) -> None:
    forms = exact_of("crowd").forms(3)
    for form in (forms.a, forms.b, forms.c, forms.s, *forms.range, *forms.cap):
        exact = [Fraction(int(whole), int(form.over)) * Fraction(2) ** exponent for whole in form.whole]
        # Python rounds a Fraction to the nearest double, subnormal ones included.
        assert form.rounded(exponent).tolist() == [float(value) for value in exact]


def test_a_coefficient_beyond_binary64_is_an_error() -> None:
    with pytest.raises(OverflowError):
        exact_of("crowd").forms(3).c.rounded(2000)


def test_forms_that_vanish_identically_are_seen_to() -> None:
    end_on = exact_scene([{"shape": "cylinder"}, {"shape": "sphere"}], ORTHOGRAPHIC)
    assert [form.vanishes() for form in (end_on.forms(0).a, end_on.forms(0).b, end_on.forms(0).s)] == [True] * 3
    assert not end_on.forms(0).c.vanishes()
    assert not end_on.forms(1).s.vanishes()
    double = exact_scene([{"shape": "quadric", "coefficients": [1, 2, 3, 4, 4, 6, 8, 9, 12, 16]}], PINHOLE)
    assert double.forms(0).s.vanishes()


def test_sign_of_the_fixed_form_is_exact() -> None:
    """At the eye (2^-30, 0, 0) inside, on and outside a ball: the last bit of the radius decides."""
    eye = [[1, 0, 0, 1e8], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    radii = [float(np.nextafter(1e8, 0)), 1e8, float(np.nextafter(1e8, 1e9))]
    balls: list[Document] = [{"shape": "sphere", "radius": radius} for radius in radii]
    scene = exact_scene(balls, {**PINHOLE, "world_from_camera": eye})
    assert [scene.sign_fixed(k) for k in range(3)] == [1, 0, -1]
    scene = exact_scene([{"shape": "sphere"}, {"shape": "cylinder"}, {"shape": "cone"}], ORTHOGRAPHIC)
    assert [scene.sign_fixed(k) for k in range(3)] == [1, 0, -1]


def test_same_surface_means_proportional_equations_in_the_world() -> None:
    place: Document = {"center": [0.1, 0.2, -3]}
    ball = {"shape": "sphere", "radius": 1.5, **place}
    quadrics: list[Document] = [
        ball,
        {"shape": "ellipsoid", "radii": [1.5, 1.5, 1.5], **place},
        {"shape": "quadric", "matrix": np.diag([-4.0, -4, -4, 9]).tolist(), **place},
        {**ball, "radius": float(np.nextafter(1.5, 2))},
        {**ball, "center": [0.1, 0.2, -3.0000000000000004]},
        {**ball, "z_range": [0, 1]},
    ]
    scene = exact_scene(quadrics, PINHOLE)
    assert [scene.same_surface(0, SURFACE, k, SURFACE) for k in range(6)] == [True, True, True, False, False, True]


def test_a_cap_is_the_same_surface_as_the_plane_it_lies_in() -> None:
    can: Document = {"shape": "cylinder", "center": [0, 0, -4], "z_range": [-1, 1], "capped": True}
    quadrics: list[Document] = [
        can,
        {"shape": "plane", "center": [7, 0, -3]},
        {"shape": "plane", "center": [0, 7, -5], "rotation": [1, 0, 0, 0]},
        {"shape": "quadric", "coefficients": [0, 0, 0, 0, 0, 0, 0, 1, 3, 9]},
        {"shape": "parallel_planes", "center": [0, 0, -4]},
        {"shape": "plane", "center": [0, 0, -3], "rotation": [1, 0, 0, 1e9]},
        {**can, "center": [0, 0, -2], "radius": 5},
    ]
    scene = exact_scene(quadrics, PINHOLE)
    high = [scene.same_surface(0, CAP_HIGH, k, SURFACE) for k in range(6)]
    low = [scene.same_surface(0, CAP_LOW, k, SURFACE) for k in range(6)]
    assert high == [False, True, False, True, False, False]
    assert low == [False, False, True, False, False, False]
    assert scene.same_surface(0, CAP_HIGH, 6, CAP_LOW)
    assert not scene.same_surface(0, CAP_HIGH, 6, CAP_HIGH)
