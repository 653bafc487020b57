"""Mistakes in the camera."""

from tests.malformed.case import IDENTITY, LOOK_AT, Case, camera, document, lens

SIZE = '"width": 64, "height": 48'
MIRROR = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]"
SCALED = "[[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]"
SHEARED = "[[1, 0.001, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
# R^T R - I is 1.000001e-6 in one entry: just too far from a rotation.
BARELY_SHEARED = "[[1, 0.000001000001, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
HUGE = "[[1e308, 0, 0, 0], [0, 1e308, 0, 0], [0, 0, 1e308, 0], [0, 0, 0, 1]]"
PROJECTIVE = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]"


def look_at(eye: str = "[0, 0, 5]", target: str = "[0, 0, 0]", up: str = "[0, 1, 0]") -> bytes:
    """A document whose camera looks so."""
    return camera(f'"look_at": {{"eye": {eye}, "target": {target}, "up": {up}}}')


LENSES = [
    Case("camera null", document(camera="null"), "camera", "scene-type"),
    Case("camera a list", document(camera="[]"), "camera", "scene-type"),
    Case("unknown key of a camera", camera('"fov": 40'), "camera.fov", "scene-unknown-key"),
    Case("width missing", lens('"height": 48, "fov_y": 40'), "camera.width", "scene-missing"),
    Case("height missing", lens('"width": 64, "fov_y": 40'), "camera.height", "scene-missing"),
    Case("width zero", lens('"width": 0, "height": 48, "fov_y": 40'), "camera.width", "scene-value"),
    Case("width negative", lens('"width": -64, "height": 48, "fov_y": 40'), "camera.width", "scene-value"),
    Case("width too large", lens('"width": 16777217, "height": 48, "fov_y": 40'), "camera.width", "scene-value"),
    Case(
        "width beyond int64",
        lens('"width": 1' + 30 * "0" + ', "height": 48, "fov_y": 40'),
        "camera.width",
        "scene-value",
    ),
    Case(
        "width with a fraction", lens('"width": 64.0, "height": 48, "fov_y": 40'), "camera.width", "scene-type", False
    ),
    Case(
        "width with an exponent", lens('"width": 64e0, "height": 48, "fov_y": 40'), "camera.width", "scene-type", False
    ),
    Case("height true", lens('"width": 64, "height": true, "fov_y": 40'), "camera.height", "scene-type"),
    Case("height a string", lens('"width": 64, "height": "48", "fov_y": 40'), "camera.height", "scene-type"),
    Case("width given twice", camera('"width": 64'), "camera.width", "scene-duplicate-key", False),
    Case("projection unknown", camera('"projection": "fisheye"'), "camera.projection", "scene-value"),
    Case("projection null", camera('"projection": null'), "camera.projection", "scene-type"),
    Case("projection a list", camera('"projection": []'), "camera.projection", "scene-type"),
    Case("no focal length", lens(SIZE), "camera", "scene-missing"),
    Case("fx without fy", lens(f'{SIZE}, "fx": 100'), "camera.fy", "scene-missing"),
    Case("fy without fx", lens(f'{SIZE}, "fy": 100'), "camera.fx", "scene-missing"),
    Case("fov_y beside fov_x", camera('"fov_x": 40'), "camera.fov_x", "scene-conflict"),
    Case("fov_y beside fx", camera('"fx": 100'), "camera.fx", "scene-conflict"),
    Case("fov_y beside fx and fy", camera('"fx": 100, "fy": 100'), "camera.fx", "scene-conflict"),
    Case("fov_y zero", lens(f'{SIZE}, "fov_y": 0'), "camera.fov_y", "scene-value"),
    Case("fov_y negative", lens(f'{SIZE}, "fov_y": -40'), "camera.fov_y", "scene-value"),
    Case("fov_y 180", lens(f'{SIZE}, "fov_y": 180'), "camera.fov_y", "scene-value"),
    Case("fov_x 360", lens(f'{SIZE}, "fov_x": 360'), "camera.fov_x", "scene-value"),
    Case("fov_y too small", lens(f'{SIZE}, "fov_y": 5e-324'), "camera.fov_y", "scene-value", False),
    Case("fov_x too small", lens(f'{SIZE}, "fov_x": 1e-306'), "camera.fov_x", "scene-value", False),
    Case("fov_y a string", lens(f'{SIZE}, "fov_y": "40"'), "camera.fov_y", "scene-type"),
    Case("fov_y NaN", lens(f'{SIZE}, "fov_y": NaN'), "camera.fov_y", "scene-value", None),
    Case("fx zero", lens(f'{SIZE}, "fx": 0, "fy": 1'), "camera.fx", "scene-value"),
    Case("fy negative", lens(f'{SIZE}, "fx": 1, "fy": -1'), "camera.fy", "scene-value"),
    Case("cx a string", camera('"cx": "32"'), "camera.cx", "scene-type"),
    Case("cy infinite", camera('"cy": -Infinity'), "camera.cy", "scene-value", None),
    Case("view_height of a pinhole", camera('"view_height": 2'), "camera.view_height", "scene-unknown-key"),
    Case(
        "fov_y of an orthographic camera",
        lens(f'{SIZE}, "projection": "orthographic", "view_height": 2, "fov_y": 40'),
        "camera.fov_y",
        "scene-unknown-key",
    ),
    Case("orthographic without a scale", lens(f'{SIZE}, "projection": "orthographic"'), "camera", "scene-missing"),
    Case(
        "orthographic with fx alone",
        lens(f'{SIZE}, "projection": "orthographic", "fx": 2'),
        "camera.fy",
        "scene-missing",
    ),
    Case(
        "view_height beside fx and fy",
        lens(f'{SIZE}, "projection": "orthographic", "view_height": 2, "fx": 2, "fy": 2'),
        "camera.fx",
        "scene-conflict",
    ),
    Case(
        "view_height zero",
        lens(f'{SIZE}, "projection": "orthographic", "view_height": 0'),
        "camera.view_height",
        "scene-value",
    ),
    Case(
        "view_height too small",
        lens(f'{SIZE}, "projection": "orthographic", "view_height": 1e-320'),
        "camera.view_height",
        "scene-value",
        False,
    ),
]

POSES = [
    Case("convention unknown", camera('"convention": "colmap"'), "camera.convention", "scene-value"),
    Case("convention true", camera('"convention": true'), "camera.convention", "scene-type"),
    Case(
        "pose beside look_at", camera(f'"world_from_camera": {IDENTITY}, {LOOK_AT}'), "camera.look_at", "scene-conflict"
    ),
    Case("pose mirrored", camera(f'"world_from_camera": {MIRROR}'), "camera.world_from_camera", "scene-value", False),
    Case("pose scaled", camera(f'"world_from_camera": {SCALED}'), "camera.world_from_camera", "scene-value", False),
    Case("pose sheared", camera(f'"world_from_camera": {SHEARED}'), "camera.world_from_camera", "scene-value", False),
    Case(
        "pose barely sheared",
        camera(f'"world_from_camera": {BARELY_SHEARED}'),
        "camera.world_from_camera",
        "scene-value",
        False,
    ),
    Case("pose huge", camera(f'"world_from_camera": {HUGE}'), "camera.world_from_camera", "scene-value", False),
    Case("pose projective", camera(f'"world_from_camera": {PROJECTIVE}'), "camera.world_from_camera[3]", "scene-value"),
    Case(
        "pose a list",
        camera('"world_from_camera": [1, [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]'),
        "camera.world_from_camera[0]",
        "scene-type",
    ),
    Case(
        "pose with NaN",
        camera(f'"world_from_camera": {IDENTITY.replace("1", "NaN", 1)}'),
        "camera.world_from_camera[0][0]",
        "scene-value",
        None,
    ),
    Case("look_at null", camera('"look_at": null'), "camera.look_at", "scene-type"),
    Case("look_at a point", camera('"look_at": [0, 0, 0]'), "camera.look_at", "scene-type"),
    Case(
        "look_at without up",
        camera('"look_at": {"eye": [0, 0, 5], "target": [0, 0, 0]}'),
        "camera.look_at.up",
        "scene-missing",
    ),
    Case(
        "look_at with an unknown key",
        camera(f'{LOOK_AT[:-1]}, "from": 1}}'),
        "camera.look_at.from",
        "scene-unknown-key",
    ),
    Case(
        "look_at with a key twice",
        camera(f'{LOOK_AT[:-1]}, "up": [0, 1, 0]}}'),
        "camera.look_at.up",
        "scene-duplicate-key",
        False,
    ),
    Case("look_at itself", look_at(target="[0, 0, 5]"), "camera.look_at.target", "scene-value", False),
    Case(
        "look_at itself but for the sign of zero",
        look_at("[0, 0, 0]", "[0, -0.0, 0]"),
        "camera.look_at.target",
        "scene-value",
        False,
    ),
    Case("up zero", look_at(up="[0, 0, 0]"), "camera.look_at.up", "scene-value"),
    Case("up along the view", look_at(up="[0, 0, 1]"), "camera.look_at.up", "scene-value", False),
    Case("up against the view", look_at(up="[0, 0, -2]"), "camera.look_at.up", "scene-value", False),
    Case(
        "up along a slanting view",
        look_at("[1, 2, 3]", "[0, 0, 0]", "[0.1, 0.2, 0.3]"),
        "camera.look_at.up",
        "scene-value",
        False,
    ),
    Case("up as good as along the view", look_at(up="[0, 1e-10, 1]"), "camera.look_at.up", "scene-value", False),
    Case(
        "up along a huge view",
        look_at("[1e308, 0, 0]", "[-1e308, 0, 0]", "[1e-300, 0, 0]"),
        "camera.look_at.up",
        "scene-value",
        False,
    ),
    Case("eye of two", look_at(eye="[0, 0]"), "camera.look_at.eye", "scene-length"),
    Case("target with a string", look_at(target='[0, 0, "0"]'), "camera.look_at.target[2]", "scene-type"),
]

WINDOWS = [
    Case("near negative", camera('"near": -1'), "camera.near", "scene-value"),
    Case("near beyond far", camera('"near": 2, "far": 1'), "camera.far", "scene-value", False),
    Case("far negative", camera('"far": -1'), "camera.far", "scene-value"),
    Case("far a word", camera('"far": "inf"'), "camera.far", "scene-type"),
    Case("far null", camera('"far": null'), "camera.far", "scene-type"),
    Case("far Infinity", camera('"far": Infinity'), "camera.far", "scene-value", None),
    Case("crop empty", camera('"crop": [8, 8, 8, 16]'), "camera.crop", "scene-value", False),
    Case("crop backwards", camera('"crop": [8, 16, 16, 8]'), "camera.crop", "scene-value", False),
    Case("crop too wide", camera('"crop": [0, 0, 65, 48]'), "camera.crop", "scene-value", False),
    Case("crop too high", camera('"crop": [0, 0, 64, 49]'), "camera.crop", "scene-value", False),
    Case("crop left of the image", camera('"crop": [-1, 0, 8, 8]'), "camera.crop[0]", "scene-value"),
    Case("crop of three", camera('"crop": [0, 0, 8]'), "camera.crop", "scene-length"),
    Case("crop with a fraction", camera('"crop": [0, 0, 8.0, 8]'), "camera.crop[2]", "scene-type", False),
    Case("crop with a half", camera('"crop": [0, 0, 8.5, 8]'), "camera.crop[2]", "scene-type"),
    Case("crop with true", camera('"crop": [0, 0, true, 8]'), "camera.crop[2]", "scene-type"),
]

CASES = [*LENSES, *POSES, *WINDOWS]
