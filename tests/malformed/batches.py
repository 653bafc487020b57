"""Mistakes in documents with many cameras."""

from tests.malformed.case import Case

_CAMERA = b'{"width": 4, "height": 3, "fov_y": 40}'


def _batch(cameras: bytes, rest: bytes = b"") -> bytes:
    return b'{"conicoid": 1, "quadrics": [], "cameras": ' + cameras + rest + b"}"


BATCHES = [
    Case("no cameras", _batch(b"[]"), "cameras", "scene-length"),
    Case("cameras an object", _batch(_CAMERA), "cameras", "scene-type"),
    Case("cameras null", _batch(b"null"), "cameras", "scene-type"),
    Case(
        "a camera beside cameras", _batch(b"[" + _CAMERA + b"]", b', "camera": ' + _CAMERA), "camera", "scene-conflict"
    ),
    Case("a camera that is none", _batch(b"[" + _CAMERA + b", 7]"), "cameras[1]", "scene-type"),
    Case(
        "one angle of many",
        _batch(b"[" + b", ".join([_CAMERA] * 40 + [_CAMERA.replace(b"40", b"180")]) + b"]"),
        "cameras[40].fov_y",
        "scene-value",
    ),
    Case(
        "a key of one of many",
        _batch(b"[" + _CAMERA + b", " + _CAMERA[:-1] + b', "wide": 1}]'),
        "cameras[1].wide",
        "scene-unknown-key",
    ),
    Case(
        "repeated cameras",
        _batch(b"[" + _CAMERA + b"]", b', "cameras": [' + _CAMERA + b"]"),
        "cameras",
        "scene-duplicate-key",
    ),
]
