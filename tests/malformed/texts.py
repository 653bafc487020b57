"""Bodies that are not JSON, or not one scene object."""

import numpy as np

from tests.malformed.case import Case, document

SOUND = document()

CASES = [
    Case("empty body", b"", "", "scene-json", None),
    Case("only spaces", b"  \n ", "", "scene-json", None),
    Case("truncated", SOUND[:-10], "", "scene-json", None),
    Case("closing brace missing", SOUND[:-1], "", "scene-json", None),
    Case("text after the document", SOUND + b" x", "", "scene-json", None),
    Case("two documents", SOUND + SOUND, "", "scene-json", None),
    Case("trailing comma in an object", SOUND[:-1] + b",}", "", "scene-json", None),
    Case("trailing comma in a list", document('[{"shape": "sphere"},]'), "", "scene-json", None),
    Case("missing comma", document('[{"shape": "sphere" "radius": 1}]'), "", "scene-json", None),
    Case("missing colon", document('[{"shape" "sphere"}]'), "", "scene-json", None),
    Case("single quotes", document("[{'shape': 'sphere'}]"), "", "scene-json", None),
    Case("key without quotes", document('[{shape: "sphere"}]'), "", "scene-json", None),
    Case("comment", b"// a scene\n" + SOUND, "", "scene-json", None),
    Case("byte order mark", b"\xef\xbb\xbf" + SOUND, "", "scene-json", None),
    Case("UTF-16", SOUND.decode().encode("utf-16"), "", "scene-json", None),
    Case("Latin-1", '{"conicoid": 1, "naïve": 1}'.encode("latin-1"), "", "scene-json", None),
    Case("overlong UTF-8", b'{"\xc0\xaf": 1}', "", "scene-json", None),
    Case("surrogate in UTF-8", b'{"\xed\xa0\x80": 1}', "", "scene-json", None),
    Case("NUL after the document", SOUND + b"\0", "", "scene-json", None),
    Case("line break in a string", document('[{"shape": "sphere", "name": "a\nb"}]'), "", "scene-json", None),
    Case("unknown escape", document('[{"shape": "sphere", "name": "\\x"}]'), "", "scene-json", None),
    Case("number with a leading zero", document('[{"shape": "sphere", "radius": 01}]'), "", "scene-json", None),
    Case(
        "number without digits after the point", document('[{"shape": "sphere", "radius": 1.}]'), "", "scene-json", None
    ),
    Case(
        "number without digits before the point",
        document('[{"shape": "sphere", "radius": .5}]'),
        "",
        "scene-json",
        None,
    ),
    Case("number with a plus", document('[{"shape": "sphere", "radius": +1}]'), "", "scene-json", None),
    Case("hexadecimal number", document('[{"shape": "sphere", "radius": 0x1}]'), "", "scene-json", None),
    Case("True", document('[{"shape": "sphere", "capped": True}]'), "", "scene-json", None),
    Case("100,000 nested lists", b"[" * 100_000, "", "scene-json", None),
    Case("100,000 nested objects", b'{"quadrics":' * 100_000, "", "scene-json", None),
    Case("a list", b"[]", "", "scene-type"),
    Case("null", b"null", "", "scene-type"),
    Case("a number", b"1", "", "scene-type"),
    Case("a string", b'"scene"', "", "scene-type"),
    Case("true", b"true", "", "scene-type"),
    Case("NaN alone", b"NaN", "", "scene-type", None),
    Case(
        "no version", b'{"quadrics": [], "camera": {"width": 1, "height": 1, "fov_y": 1}}', "conicoid", "scene-missing"
    ),
    Case(
        "no quadrics", b'{"conicoid": 1, "camera": {"width": 1, "height": 1, "fov_y": 1}}', "quadrics", "scene-missing"
    ),
    Case("no camera", b'{"conicoid": 1, "quadrics": []}', "camera", "scene-missing"),
    Case("later version", SOUND.replace(b": 1", b": 2"), "conicoid", "scene-unsupported"),
    Case("version as a string", SOUND.replace(b": 1", b': "1"'), "conicoid", "scene-type"),
    Case("version with a fraction", SOUND.replace(b": 1", b": 1.0"), "conicoid", "scene-type", False),
    Case("version true", SOUND.replace(b": 1", b": true"), "conicoid", "scene-type"),
    Case("unknown key", document(rest=', "lights": []'), "lights", "scene-unknown-key"),
    Case("misspelt key", document(rest=', "outputs": {}'), "outputs", "scene-unknown-key"),
    Case("key in capitals", document(rest=', "Output": {}'), "Output", "scene-unknown-key"),
    Case("empty key", document(rest=', "": 1'), '[""]', "scene-unknown-key"),
    Case("key with a dot", document(rest=', "a.b": 1'), '["a.b"]', "scene-unknown-key"),
    Case("key of half a surrogate pair", document(rest=', "\\ud800": 1'), '["\\ud800"]', "scene-unknown-key"),
    Case("repeated key", document(rest=', "conicoid": 1'), "conicoid", "scene-duplicate-key", False),
    Case(
        "repeated key in other letters",
        document(rest=', "con\\u0069coid": 1'),
        "conicoid",
        "scene-duplicate-key",
        False,
    ),
    Case("quadrics beside a kept scene", document(rest=', "scene": "a1"'), "scene", "scene-conflict"),
    Case("kept scene a number", document(rest=', "scene": 1').replace(b'"quadrics": [], ', b""), "scene", "scene-type"),
    Case("kept scene null", document(rest=', "scene": null').replace(b'"quadrics": [], ', b""), "scene", "scene-type"),
    Case(
        "array beside a kept scene",
        document(rest=', "scene": "a1"').replace(b'"quadrics": [], ', b""),
        "arrays.a",
        "scene-array",
        False,
        {"a": np.ones(1)},
    ),
]
