"""Mistakes in quadrics."""

from tests.malformed.case import IDENTITY, Case, document, shaped, sphere

SINGULAR = "[[1, 2, 3, 0], [4, 5, 6, 0], [7, 8, 9, 0], [0, 0, 0, 1]]"
# Row 2 is row 1 + 2 * row 0 exactly, yet the determinant in binary64 arithmetic is 8e-17.
SINGULAR_IN_BINARY = "[[-0.9, -0.2, -0.1, 0], [0.8, 0.9, -0.3, 0], [-1.0, 0.5, -0.5, 0], [0, 0, 0, 1]]"
SINGULAR_AND_TINY = "[[1e-200, 1e-200, 0, 0], [1e-200, 1e-200, 0, 0], [0, 0, 1e-200, 0], [0, 0, 0, 1]]"
SINGULAR_AND_HUGE = "[[1e300, 1e300, 0, 0], [1e300, 1e300, 0, 0], [0, 0, 1e300, 0], [0, 0, 0, 1]]"
FLAT = "[[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
PROJECTIVE = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0.5, 1]]"
SCALED_LAST = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 2]]"
ASYMMETRIC = "[[1, 2, 0, 0], [3, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1]]"
ZERO = "[[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]"
NINE_CLIPS = ", ".join(["[0, 0, 1, 0]"] * 9)

LISTS = [
    Case("quadrics an object", document('{"shape": "sphere"}'), "quadrics", "scene-type"),
    Case("quadrics null", document("null"), "quadrics", "scene-type"),
    Case("quadrics a string", document('"sphere"'), "quadrics", "scene-type"),
    Case("quadric null", document('[{"shape": "sphere"}, null]'), "quadrics[1]", "scene-type"),
    Case("quadric a list", document("[[]]"), "quadrics[0]", "scene-type"),
    Case("quadric a number", document("[NaN]"), "quadrics[0]", "scene-type", None),
    Case("quadric without shape", document('[{"radius": 1}]'), "quadrics[0].shape", "scene-missing"),
    Case("empty quadric", document("[{}]"), "quadrics[0].shape", "scene-missing"),
    Case("shape unknown", document('[{"shape": "torus"}]'), "quadrics[0].shape", "scene-value"),
    Case("shape in capitals", document('[{"shape": "Sphere"}]'), "quadrics[0].shape", "scene-value"),
    Case("shape empty", document('[{"shape": ""}]'), "quadrics[0].shape", "scene-value"),
    Case("shape null", document('[{"shape": null}]'), "quadrics[0].shape", "scene-type"),
    Case("shape a number", document('[{"shape": 3}]'), "quadrics[0].shape", "scene-type"),
    Case("shape a list", document('[{"shape": ["sphere"]}]'), "quadrics[0].shape", "scene-type"),
    Case("shape beyond binary64", document('[{"shape": 1e999}]'), "quadrics[0].shape", "scene-type", None),
    Case("shape of half a surrogate pair", document('[{"shape": "\\udc00"}]'), "quadrics[0].shape", "scene-value"),
    Case("shape given twice", sphere('"shape": "sphere"'), "quadrics[1].shape", "scene-duplicate-key", False),
    Case("quadric with an unknown key", sphere('"colour": 1'), "quadrics[1].colour", "scene-unknown-key"),
    Case("quadric with a misspelt key", sphere('"centre": [0, 0, 0]'), "quadrics[1].centre", "scene-unknown-key"),
]

PARAMETERS = [
    Case("radius negative", sphere('"radius": -1'), "quadrics[1].radius", "scene-value"),
    Case("radius zero", sphere('"radius": 0'), "quadrics[1].radius", "scene-value"),
    Case("radius minus zero", sphere('"radius": -0.0'), "quadrics[1].radius", "scene-value"),
    Case("radius underflows to zero", sphere('"radius": 1e-400'), "quadrics[1].radius", "scene-value"),
    Case("radius a string", sphere('"radius": "1"'), "quadrics[1].radius", "scene-type"),
    Case("radius true", sphere('"radius": true'), "quadrics[1].radius", "scene-type"),
    Case("radius null", sphere('"radius": null'), "quadrics[1].radius", "scene-type"),
    Case("radius a list", sphere('"radius": [1]'), "quadrics[1].radius", "scene-type"),
    Case("radius an object", sphere('"radius": {}'), "quadrics[1].radius", "scene-type"),
    Case("radius NaN", sphere('"radius": NaN'), "quadrics[1].radius", "scene-value", None),
    Case("radius Infinity", sphere('"radius": Infinity'), "quadrics[1].radius", "scene-value", None),
    Case("radius -Infinity", sphere('"radius": -Infinity'), "quadrics[1].radius", "scene-value", None),
    Case("radius 1e999", sphere('"radius": 1e999'), "quadrics[1].radius", "scene-value", None),
    Case(
        "radius rounds to infinity",
        sphere('"radius": 1.7976931348623159e308'),
        "quadrics[1].radius",
        "scene-value",
        None,
    ),
    Case("radius of 5,000 digits", sphere(f'"radius": {"9" * 5000}'), "quadrics[1].radius", "scene-value", None),
    Case("radius of 309 digits", sphere(f'"radius": {"9" * 309}'), "quadrics[1].radius", "scene-value", None),
    Case("radius given twice", sphere('"radius": 1, "radius": 1'), "quadrics[1].radius", "scene-duplicate-key", False),
    Case("radii of a sphere", sphere('"radii": [1, 1, 1]'), "quadrics[1].radii", "scene-unknown-key"),
    Case("radius of an ellipsoid", shaped("ellipsoid", '"radius": 1'), "quadrics[1].radius", "scene-unknown-key"),
    Case("radius of a plane", shaped("plane", '"radius": 1'), "quadrics[1].radius", "scene-unknown-key"),
    Case(
        "radius of a quadric",
        shaped("quadric", f'"radius": 1, "matrix": {IDENTITY}'),
        "quadrics[1].radius",
        "scene-unknown-key",
    ),
    Case("matrix of a sphere", sphere(f'"matrix": {IDENTITY}'), "quadrics[1].matrix", "scene-unknown-key"),
    Case("radius beside radii", shaped("cone", '"radius": 1, "radii": [1, 1]'), "quadrics[1].radii", "scene-conflict"),
    Case("two radii of an ellipsoid", shaped("ellipsoid", '"radii": [1, 1]'), "quadrics[1].radii", "scene-length"),
    Case("three radii of a cylinder", shaped("cylinder", '"radii": [1, 1, 1]'), "quadrics[1].radii", "scene-length"),
    Case("no radii", shaped("cylinder", '"radii": []'), "quadrics[1].radii", "scene-length"),
    Case("one of the radii negative", shaped("cone", '"radii": [1, -2]'), "quadrics[1].radii[1]", "scene-value"),
    Case("one of the radii zero", shaped("ellipsoid", '"radii": [1, 0, 2]'), "quadrics[1].radii[1]", "scene-value"),
    Case("one of the radii a string", shaped("paraboloid", '"radii": ["1", 2]'), "quadrics[1].radii[0]", "scene-type"),
    Case(
        "one of the radii a list", shaped("crossed_planes", '"radii": [[1], 2]'), "quadrics[1].radii[0]", "scene-type"
    ),
    Case("radii a number", shaped("ellipsoid", '"radii": 1'), "quadrics[1].radii", "scene-type"),
    Case("quadric without parameters", shaped("quadric"), "quadrics[1]", "scene-missing"),
    Case(
        "matrix beside coefficients",
        shaped("quadric", f'"matrix": {IDENTITY}, "coefficients": [1, 0, 0, 0, 1, 0, 0, 1, 0, -1]'),
        "quadrics[1].coefficients",
        "scene-conflict",
    ),
    Case("matrix asymmetric", shaped("quadric", f'"matrix": {ASYMMETRIC}'), "quadrics[1].matrix", "scene-value", False),
    Case("matrix all zero", shaped("quadric", f'"matrix": {ZERO}'), "quadrics[1].matrix", "scene-value", False),
    Case(
        "matrix of three rows",
        shaped("quadric", '"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]'),
        "quadrics[1].matrix",
        "scene-length",
    ),
    Case(
        "matrix with a short row",
        shaped("quadric", '"matrix": [[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0], [0, 0, 0, -1]]'),
        "quadrics[1].matrix[1]",
        "scene-length",
    ),
    Case(
        "matrix in one list",
        shaped("quadric", f'"matrix": [{", ".join("1" * 16)}]'),
        "quadrics[1].matrix",
        "scene-length",
    ),
    Case(
        "nine coefficients",
        shaped("quadric", f'"coefficients": [{", ".join("1" * 9)}]'),
        "quadrics[1].coefficients",
        "scene-length",
    ),
    Case(
        "coefficients all zero",
        shaped("quadric", f'"coefficients": [{", ".join("0" * 10)}]'),
        "quadrics[1].coefficients",
        "scene-value",
    ),
    Case(
        "coefficients underflow to zero",
        shaped("quadric", f'"coefficients": [{", ".join(["1e-999"] * 10)}]'),
        "quadrics[1].coefficients",
        "scene-value",
    ),
    Case(
        "coefficient NaN",
        shaped("quadric", f'"coefficients": [{", ".join("1" * 9)}, NaN]'),
        "quadrics[1].coefficients[9]",
        "scene-value",
        None,
    ),
]

PLACEMENTS = [
    Case("center of two", sphere('"center": [0, 0]'), "quadrics[1].center", "scene-length"),
    Case("center of four", sphere('"center": [0, 0, 0, 1]'), "quadrics[1].center", "scene-length"),
    Case("center a number", sphere('"center": 0'), "quadrics[1].center", "scene-type"),
    Case("center an object", sphere('"center": {"x": 0}'), "quadrics[1].center", "scene-type"),
    Case("center with a string", sphere('"center": [0, "0", 0]'), "quadrics[1].center[1]", "scene-type"),
    Case("center with null", sphere('"center": [0, 0, null]'), "quadrics[1].center[2]", "scene-type"),
    Case("center with false", sphere('"center": [false, 0, 0]'), "quadrics[1].center[0]", "scene-type"),
    Case("center with NaN", sphere('"center": [0, 0, NaN]'), "quadrics[1].center[2]", "scene-value", None),
    Case("center with -1e400", sphere('"center": [-1e400, 0, 0]'), "quadrics[1].center[0]", "scene-value", None),
    Case("center nested", sphere('"center": [[0, 0, 0]]'), "quadrics[1].center", "scene-length"),
    Case("center an array's name", sphere('"center": "@center"'), "quadrics[1].center", "scene-type"),
    Case("rotation zero", sphere('"rotation": [0, 0, 0, 0]'), "quadrics[1].rotation", "scene-value"),
    Case("rotation minus zero", sphere('"rotation": [0, -0.0, 0, 0]'), "quadrics[1].rotation", "scene-value"),
    Case("rotation of three", sphere('"rotation": [0, 0, 0]'), "quadrics[1].rotation", "scene-length"),
    Case(
        "rotation a matrix",
        sphere('"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]'),
        "quadrics[1].rotation",
        "scene-length",
    ),
    Case(
        "transform beside center",
        sphere(f'"transform": {IDENTITY}, "center": [0, 0, 0]'),
        "quadrics[1].center",
        "scene-conflict",
    ),
    Case(
        "transform beside rotation",
        sphere(f'"rotation": [0, 0, 0, 1], "transform": {IDENTITY}'),
        "quadrics[1].rotation",
        "scene-conflict",
    ),
    Case("transform singular", sphere(f'"transform": {SINGULAR}'), "quadrics[1].transform", "scene-value", False),
    Case(
        "transform singular in binary",
        sphere(f'"transform": {SINGULAR_IN_BINARY}'),
        "quadrics[1].transform",
        "scene-value",
        False,
    ),
    Case(
        "transform singular and tiny",
        sphere(f'"transform": {SINGULAR_AND_TINY}'),
        "quadrics[1].transform",
        "scene-value",
        False,
    ),
    Case(
        "transform singular and huge",
        sphere(f'"transform": {SINGULAR_AND_HUGE}'),
        "quadrics[1].transform",
        "scene-value",
        False,
    ),
    Case("transform flat", sphere(f'"transform": {FLAT}'), "quadrics[1].transform", "scene-value", False),
    Case("transform projective", sphere(f'"transform": {PROJECTIVE}'), "quadrics[1].transform[3]", "scene-value"),
    Case(
        "transform with 2 in the corner",
        sphere(f'"transform": {SCALED_LAST}'),
        "quadrics[1].transform[3]",
        "scene-value",
    ),
    Case(
        "transform of three rows",
        sphere('"transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]'),
        "quadrics[1].transform",
        "scene-length",
    ),
    Case(
        "transform with a string",
        sphere('"transform": [[1, 0, 0, 0], [0, 1, 0, "x"], [0, 0, 1, 0], [0, 0, 0, 1]]'),
        "quadrics[1].transform[1][3]",
        "scene-type",
    ),
]

EXTENTS = [
    Case("z_range backwards", sphere('"z_range": [1, -1]'), "quadrics[1].z_range", "scene-value", False),
    Case("z_range of one, capped", sphere('"z_range": [1], "capped": true'), "quadrics[1].z_range", "scene-length"),
    Case("z_range of one", sphere('"z_range": [1]'), "quadrics[1].z_range", "scene-length"),
    Case("z_range with null", sphere('"z_range": [null, 1]'), "quadrics[1].z_range[0]", "scene-type"),
    Case("z_range with Infinity", sphere('"z_range": [0, Infinity]'), "quadrics[1].z_range[1]", "scene-value", None),
    Case("capped without z_range", shaped("cylinder", '"capped": true'), "quadrics[1].capped", "scene-missing"),
    Case("capped a number", sphere('"z_range": [0, 1], "capped": 1'), "quadrics[1].capped", "scene-type"),
    Case("capped a string", sphere('"z_range": [0, 1], "capped": "true"'), "quadrics[1].capped", "scene-type"),
    Case("capped null", sphere('"z_range": [0, 1], "capped": null'), "quadrics[1].capped", "scene-type"),
    Case("nine clips", sphere(f'"clip": [{NINE_CLIPS}]'), "quadrics[1].clip", "scene-length"),
    Case("clip not nested", sphere('"clip": [5]'), "quadrics[1].clip[0]", "scene-type"),
    Case("clip of three numbers", sphere('"clip": [[0, 0, 1, 0], [0, 0, 1]]'), "quadrics[1].clip[1]", "scene-length"),
    Case("clip an object", sphere('"clip": {}'), "quadrics[1].clip", "scene-type"),
    Case("clip with a string", sphere('"clip": [[0, 0, 1, "0"]]'), "quadrics[1].clip[0][3]", "scene-type"),
    Case("clip with 1e309", sphere('"clip": [[0, 0, 1, 1e309]]'), "quadrics[1].clip[0][3]", "scene-value", None),
    Case("id zero", sphere('"id": 0'), "quadrics[1].id", "scene-value"),
    Case("id negative", sphere('"id": -1'), "quadrics[1].id", "scene-value"),
    Case("id too large", sphere('"id": 4294967296'), "quadrics[1].id", "scene-value"),
    Case("id far too large", sphere('"id": 99999999999999999999'), "quadrics[1].id", "scene-value"),
    Case("id beyond binary64", sphere(f'"id": {"9" * 400}'), "quadrics[1].id", "scene-value", None),
    Case("id with a fraction", sphere('"id": 1.0'), "quadrics[1].id", "scene-type", False),
    Case("id with an exponent", sphere('"id": 1e2'), "quadrics[1].id", "scene-type", False),
    Case("id a half", sphere('"id": 1.5'), "quadrics[1].id", "scene-type"),
    Case("id true", sphere('"id": true'), "quadrics[1].id", "scene-type"),
    Case("id a string", sphere('"id": "1"'), "quadrics[1].id", "scene-type"),
    Case("id null", sphere('"id": null'), "quadrics[1].id", "scene-type"),
    Case("name a number", sphere('"name": 1'), "quadrics[1].name", "scene-type"),
    Case("name null", sphere('"name": null'), "quadrics[1].name", "scene-type"),
    Case("name of half a surrogate pair", sphere('"name": "a\\ud800b"'), "quadrics[1].name", "scene-value", False),
]

CASES = [*LISTS, *PARAMETERS, *PLACEMENTS, *EXTENTS]
