"""Mistakes in sets of quadrics, and in the arrays that their fields name."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.malformed.case import IDENTITY, Case, shaped, sphere

SINGULAR = "[[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"


def two(keys: str) -> bytes:
    """A document whose quadrics[1] is a set of two spheres with these keys."""
    return sphere(f'"count": 2, {keys}')


COUNTS = [
    Case("count negative", sphere('"count": -1'), "quadrics[1].count", "scene-value"),
    Case("count with a fraction", sphere('"count": 2.0'), "quadrics[1].count", "scene-type", False),
    Case("count with an exponent", sphere('"count": 1e1'), "quadrics[1].count", "scene-type", False),
    Case("count a string", sphere('"count": "2"'), "quadrics[1].count", "scene-type"),
    Case("count an array", sphere('"count": "@n"'), "quadrics[1].count", "scene-type"),
    Case("count true", sphere('"count": true'), "quadrics[1].count", "scene-type"),
    Case("count null", sphere('"count": null'), "quadrics[1].count", "scene-type"),
    Case("count a list", sphere('"count": [2]'), "quadrics[1].count", "scene-type"),
    Case("count beyond binary64", sphere(f'"count": {"9" * 400}'), "quadrics[1].count", "scene-value", None),
    Case("count given twice", sphere('"count": 2, "count": 2'), "quadrics[1].count", "scene-duplicate-key", False),
    Case("set of an unknown shape", shaped("torus", '"count": 2'), "quadrics[1].shape", "scene-value"),
    Case("set with a list of shapes", sphere('"count": 1').replace(b'"sphere", "count"', b'["sphere"], "count"'),
         "quadrics[1].shape", "scene-type"),
    Case("set with an unknown key", two('"colour": 1'), "quadrics[1].colour", "scene-unknown-key"),
    Case("set with another shape's key", two('"radii": [1, 1, 1]'), "quadrics[1].radii", "scene-unknown-key"),
    Case("set of quadrics without form", shaped("quadric", '"count": 2'), "quadrics[1]", "scene-missing"),
    Case("set with transform and center", two(f'"center": [0, 0, 0], "transform": {IDENTITY}'), "quadrics[1].center",
         "scene-conflict"),
]  # fmt: skip

LISTS = [
    Case("too few radii in a set", two('"radius": [1]'), "quadrics[1].radius", "scene-length", False),
    Case("too many radii in a set", two('"radius": [1, 1, 1]'), "quadrics[1].radius", "scene-length", False),
    Case("no radii in a set", two('"radius": []'), "quadrics[1].radius", "scene-length", False),
    Case("shared radius of a set negative", two('"radius": -1'), "quadrics[1].radius", "scene-value"),
    Case("shared radius of a set null", two('"radius": null'), "quadrics[1].radius", "scene-type"),
    Case("radius of an element negative", two('"radius": [1, -1]'), "quadrics[1].radius[1]", "scene-value"),
    Case("radius of an element a string", two('"radius": ["1", 1]'), "quadrics[1].radius[0]", "scene-type"),
    Case("radius of an element true", two('"radius": [1, true]'), "quadrics[1].radius[1]", "scene-type"),
    Case("radius of an element NaN", two('"radius": [1, NaN]'), "quadrics[1].radius[1]", "scene-value", None),
    Case("radius of an element a list", two('"radius": [1, [1]]'), "quadrics[1].radius[1]", "scene-type"),
    Case("radius of an element given by name", two('"radius": [1, "@r"]'), "quadrics[1].radius[1]", "scene-type"),
    Case("radius of the last of many", sphere(f'"count": 99, "radius": [{"1, " * 98}0]'),
         "quadrics[1].radius[98]", "scene-value"),
    Case("shared center of two numbers", two('"center": [0, 0]'), "quadrics[1].center", "scene-length"),
    Case("one center for two", two('"center": [[0, 0, 0]]'), "quadrics[1].center", "scene-length", False),
    Case("center of an element flat", two('"center": [[0, 0, 0], 0]'), "quadrics[1].center[1]", "scene-type"),
    Case("center of an element short", two('"center": [[0, 0], [0, 0, 0]]'), "quadrics[1].center[0]", "scene-length"),
    Case("center of an element with null", two('"center": [[0, 0, 0], [0, null, 0]]'), "quadrics[1].center[1][1]",
         "scene-type"),
    Case("center nested too deeply", two('"center": [[[0, 0, 0]], [0, 0, 0]]'), "quadrics[1].center[0]",
         "scene-length"),
    Case("rotation of an element zero", two('"rotation": [[0, 0, 0, 1], [0, 0, 0, 0]]'), "quadrics[1].rotation[1]",
         "scene-value"),
    Case("transform of an element singular", two(f'"transform": [{IDENTITY}, {SINGULAR}]'),
         "quadrics[1].transform[1]", "scene-value", False),
    Case("coefficients of an element zero", shaped("quadric", f'"count": 2, "coefficients": [{[1] * 10}, {[0] * 10}]'),
         "quadrics[1].coefficients[1]", "scene-value"),
    Case("range of an element backwards", two('"z_range": [[0, 1], [1, 0]]'), "quadrics[1].z_range[1]", "scene-value",
         False),
    Case("caps of an element without range", two('"capped": [false, true]'), "quadrics[1].capped", "scene-missing"),
    Case("shared caps without range", two('"capped": true'), "quadrics[1].capped", "scene-missing"),
    Case("caps of an element a number", two('"z_range": [0, 1], "capped": [true, 1]'), "quadrics[1].capped[1]",
         "scene-type"),
    Case("shared clip flat", two('"clip": [5]'), "quadrics[1].clip[0]", "scene-type"),
    Case("shared clips too many", two(f'"clip": [{", ".join(["[0, 0, 1, 0]"] * 9)}]'), "quadrics[1].clip",
         "scene-length"),
    Case("clips of one for two", two('"clip": [[[0, 0, 1, 0]]]'), "quadrics[1].clip", "scene-length", False),
    Case("clip of an element flat", two('"clip": [[[0, 0, 1, 0]], [5]]'), "quadrics[1].clip[1][0]",
         "scene-type"),
    Case("clip of an element short", two('"clip": [[], [[0, 0, 1]]]'), "quadrics[1].clip[1][0]", "scene-length"),
    Case("id of an element zero", two('"id": [1, 0]'), "quadrics[1].id[1]", "scene-value"),
    Case("id of an element too large", two('"id": [4294967296, 1]'), "quadrics[1].id[0]", "scene-value"),
    Case("id of an element with a fraction", two('"id": [1, 2.0]'), "quadrics[1].id[1]", "scene-type", False),
    Case("first id zero", two('"id": 0'), "quadrics[1].id", "scene-value"),
    Case("consecutive ids run out", two('"id": 4294967295'), "quadrics[1].id", "scene-value", False),
    Case("name of an element a number", two('"name": ["a", 1]'), "quadrics[1].name[1]", "scene-type"),
    Case("names too few", two('"name": ["a"]'), "quadrics[1].name", "scene-length", False),
]  # fmt: skip


def array(name: str, keys: str, pointer: str, value: Any, code: str = "scene-array", shape: str = "sphere") -> Case:
    """A set of two whose field is the array `a`."""
    body = shaped(shape, f'"count": 2, {keys}')
    arrays: dict[str, NDArray[Any]] = {"a": np.asarray(value)}
    return Case(name, body, f"quadrics[1].{pointer}", code, False, arrays)


LINE = np.array([[0, 0, 1], [0, 0, 1]], np.float64)
ARRAYS = [
    Case("named array in plain JSON", two('"radius": "@a"'), "quadrics[1].radius", "scene-array", False),
    Case("empty name of an array", two('"radius": "@"'), "quadrics[1].radius", "scene-array", False),
    Case("word for a number in a set", two('"radius": "a"'), "quadrics[1].radius", "scene-type"),
    Case("named array outside a set", sphere('"radius": "@a"'), "quadrics[1].radius", "scene-type"),
    Case("array that is not there", two('"radius": "@b", "center": "@a"'), "quadrics[1].radius", "scene-array", False,
         {"a": LINE}),
    Case("array that nothing uses", two('"radius": 1'), "arrays.a", "scene-array", False, {"a": LINE}),
    Case("array only named in a name", two('"name": "@a"'), "arrays.a", "scene-array", False, {"a": LINE}),
    Case("array with a strange name", two('"radius": 1'), 'arrays["a b"]', "scene-array", False, {"a b": LINE}),
    array("array too short", '"radius": "@a"', "radius", [1.0]),
    array("array too long", '"radius": "@a"', "radius", [1.0, 1.0, 1.0]),
    array("array without rows", '"radius": "@a"', "radius", 1.0),
    array("array of integers", '"radius": "@a"', "radius", [1, 1]),
    array("array of halves", '"radius": "@a"', "radius", np.ones(2, np.float16)),
    array("array of booleans", '"radius": "@a"', "radius", [True, True]),
    array("array of pairs for a radius", '"radius": "@a"', "radius", np.ones((2, 2))),
    array("array flat for a center", '"center": "@a"', "center", [1.0, 1.0]),
    array("array of fours for a center", '"center": "@a"', "center", np.ones((2, 4))),
    array("array of flat matrices", '"transform": "@a"', "transform", np.ones((2, 16))),
    array("array of three rows for a matrix", '"transform": "@a"', "transform", np.ones((2, 3, 4))),
    array("array of nine clips", '"clip": "@a"', "clip", np.ones((2, 9, 4))),
    array("array of clips of three", '"clip": "@a"', "clip", np.ones((2, 3))),
    array("array of signed ids", '"id": "@a"', "id", np.ones(2, np.int64)),
    array("array of floating ids", '"id": "@a"', "id", np.ones(2)),
    array("array of numbers for caps", '"z_range": [0, 1], "capped": "@a"', "capped", np.ones(2, np.uint8)),
    array("array for a shared pair", '"z_range": "@a"', "z_range", [0.0, 1.0]),
    array("NaN in an array", '"radius": "@a"', "radius[1]", [1.0, np.nan], "scene-value"),
    array("infinity in an array", '"center": "@a"', "center[1][2]", [[0, 0, 0.0], [0, 0, -np.inf]], "scene-value"),
    array("infinity in float32", '"radius": "@a"', "radius[0]", np.array([np.inf, 1], np.float32), "scene-value"),
    array("signalling NaN in an array", '"radius": "@a"', "radius[1]",
          np.array([0x3F800000, 0x7FA00000], np.uint32).view(np.float32), "scene-value"),
    array("negative radius in an array", '"radius": "@a"', "radius[1]", [1.0, -1.0], "scene-value"),
    array("zero radius in an array", '"radii": "@a"', "radii[1][0]", [[1.0, 1], [0, 1]], "scene-value", "cone"),
    array("zero rotation in an array", '"rotation": "@a"', "rotation[0]", [[0, 0, 0, 0.0], [0, 0, 0, 1]],
          "scene-value"),
    array("backward range in an array", '"z_range": "@a"', "z_range[1]", [[0, 1.0], [1, 0]], "scene-value"),
    array("singular transform in an array", '"transform": "@a"', "transform[1]",
          [np.eye(4), np.diag([1.0, 0, 1, 1])], "scene-value"),
    array("projective transform in an array", '"transform": "@a"', "transform[0][3]",
          [np.diag([1.0, 1, 1, 2]), np.eye(4)], "scene-value"),
    array("NaN in a clip of an array", '"clip": "@a"', "clip[1][0][3]", [[[0, 0, 1.0, 0]], [[0, 0, 1, np.nan]]],
          "scene-value"),
    array("zero id in an array", '"id": "@a"', "id[1]", np.array([1, 0], np.uint8), "scene-value"),
    array("id beyond 32 bits in an array", '"id": "@a"', "id[0]", np.array([2**64 - 1, 1], np.uint64), "scene-value"),
    array("caps in an array without range", '"capped": "@a"', "capped", [False, True], "scene-missing"),
    array("asymmetric matrix in an array", '"matrix": "@a"', "matrix[0]",
          [np.eye(4) + np.eye(4, k=1), np.eye(4)], "scene-value", "quadric"),
]  # fmt: skip

CASES = [*COUNTS, *LISTS, *ARRAYS]
