"""Mistakes in the output."""

from tests.malformed.case import Case, document, output

CASES = [
    Case("output null", document(rest=', "output": null'), "output", "scene-type"),
    Case("output a list", document(rest=', "output": ["Z"]'), "output", "scene-type"),
    Case("unknown key of an output", output('"format": "exr"'), "output.format", "scene-unknown-key"),
    Case("misspelt key of an output", output('"chanels": ["Z"]'), "output.chanels", "scene-unknown-key"),
    Case("channels empty", output('"channels": []'), "output.channels", "scene-length"),
    Case("channels a word", output('"channels": "Z"'), "output.channels", "scene-type"),
    Case("channel unknown", output('"channels": ["Z", "RGB"]'), "output.channels[1]", "scene-value"),
    Case("channel in small letters", output('"channels": ["z"]'), "output.channels[0]", "scene-value"),
    Case("channel null", output('"channels": [null]'), "output.channels[0]", "scene-type"),
    Case("channel a list", output('"channels": [["Z"]]'), "output.channels[0]", "scene-type"),
    Case("channel repeated", output('"channels": ["Z", "N", "Z"]'), "output.channels[2]", "scene-value"),
    Case(
        "channels given twice",
        output('"channels": ["Z"], "channels": ["Z"]'),
        "output.channels",
        "scene-duplicate-key",
        False,
    ),
    Case("normal_space unknown", output('"normal_space": "object"'), "output.normal_space", "scene-value"),
    Case("normal_side unknown", output('"normal_side": "inward"'), "output.normal_side", "scene-value"),
    Case("normal_side a boolean", output('"normal_side": true'), "output.normal_side", "scene-type"),
    Case(
        "background_depth another word", output('"background_depth": "zero"'), "output.background_depth", "scene-type"
    ),
    Case("background_depth null", output('"background_depth": null'), "output.background_depth", "scene-type"),
    Case("background_depth true", output('"background_depth": true'), "output.background_depth", "scene-type"),
    Case(
        "background_depth Infinity",
        output('"background_depth": Infinity'),
        "output.background_depth",
        "scene-value",
        None,
    ),
    Case("background_depth 1e999", output('"background_depth": 1e999'), "output.background_depth", "scene-value", None),
    Case("background_depth a list", output('"background_depth": ["inf"]'), "output.background_depth", "scene-type"),
    Case("precision unknown", output('"precision": "double"'), "output.precision", "scene-value"),
    Case("precision a number", output('"precision": 64'), "output.precision", "scene-type"),
    Case("compression lossy", output('"compression": "pxr24"'), "output.compression", "scene-value"),
    Case("compression null", output('"compression": null'), "output.compression", "scene-type"),
    Case("data_window a list", output('"data_window": [0, 0, 8, 8]'), "output.data_window", "scene-type"),
    Case("data_window unknown", output('"data_window": "crop"'), "output.data_window", "scene-value"),
    Case("half_normals a number", output('"half_normals": 0'), "output.half_normals", "scene-type"),
    Case("half_normals a string", output('"half_normals": "false"'), "output.half_normals", "scene-type"),
]
