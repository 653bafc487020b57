"""Documents that ask for too much, nest too deeply, or are not quite JSON."""

from tests.hostile.case import Hostile, render

MEGABYTE = 1 << 20


def scene(
    quadrics: bytes = b"[]", camera: bytes = b'{"width": 4, "height": 4, "fov_y": 40}', rest: bytes = b""
) -> bytes:
    return b'{"conicoid": 1, "quadrics": %s, "camera": %s%s}' % (quadrics, camera, rest)


def naming(scene_id: bytes) -> bytes:
    return b'{"conicoid": 1, "scene": "%s", "camera": {"width": 4, "height": 4, "fov_y": 40}}' % scene_id


def sphere(keys: bytes) -> bytes:
    return scene(b'[{"shape": "sphere", %s}]' % keys)


def image(width: bytes, height: bytes, rest: bytes = b"") -> bytes:
    return scene(camera=b'{"width": %s, "height": %s, "fov_y": 40%s}' % (width, height, rest))


TOO_MUCH = {
    "two gigapixels": image(b"65536", b"32768"),
    "one pixel too many": image(b"67000001", b"1"),
    "pixels beyond 64 bits": image(b"4294967296", b"4294967296"),
    "pixels of a crop": image(b"100000", b"100000", b', "crop": [0, 0, 90000, 90000]'),
    "a width of 400 digits": image(b"9" * 400, b"1"),
    "a width of a million digits": image(b"9" * 1_000_000, b"1"),
    "one element too many": sphere(b'"count": 2000001'),
    "a trillion elements": sphere(b'"count": 1000000000000'),
    "elements beyond 64 bits": sphere(b'"count": 99999999999999999999999999'),
    "sets of many": scene(b"[%s]" % b",".join([b'{"shape": "sphere", "count": 1999999}'] * 1000)),
    "a count and one radius": sphere(b'"count": 2000000, "radius": [1]'),
    "a count of -1": sphere(b'"count": -1'),
    "an id past the last": sphere(b'"count": 1000000, "id": 4294967290'),
    "a million clips": sphere(b'"clip": [%s]' % b",".join([b"[1,0,0,1]"] * 500_000)),
}
NUMBERS = {
    "an exponent of ten digits": sphere(b'"radius": 1e9999999999'),
    "a negative exponent of ten digits": sphere(b'"radius": 1e-9999999999'),
    "an exponent of a million digits": sphere(b'"radius": 1e%s' % (b"9" * MEGABYTE)),
    "a fraction of a million digits": sphere(b'"radius": -0.%s' % (b"9" * MEGABYTE)),
    "NaN": sphere(b'"radius": NaN'),
    "Infinity": sphere(b'"radius": Infinity'),
    "hexadecimal": sphere(b'"radius": 0x10'),
    "an integer of a million digits": sphere(b'"center": [%s, 0, 0]' % (b"1" * MEGABYTE)),
    "a boolean for a number": sphere(b'"radius": true'),
    "minus nothing": sphere(b'"radius": -'),
}
NESTED = {
    f"{name} nested {count} deep": opening * count + closing * count
    for count in (500, 1_000, 100_000, 1_000_000)
    for name, opening, closing in (
        ("lists", b"[", b"]"), ("objects", b'{"a":', b"}"), ("open lists", b"[", b""), ("open objects", b'{"a":', b""),
        ("both", b'[{"a":', b"}]"),
    )
}  # fmt: skip
KEYS = {
    "a key twice": scene(rest=b', "camera": {}'),
    "a key 100,000 times": b"{%s}" % b",".join([b'"a": 1'] * 100_000),
    "a key and its escaped form": scene(rest=rb', "\u0063amera": {}'),
    "200,000 unknown keys": scene(rest=b"".join(b', "k%d": 1' % i for i in range(200_000))),
    "100,000 wrong quadrics": scene(b"[%s]" % b",".join([b'{"shape": 1}'] * 100_000)),
    "a key of a megabyte": scene(rest=b', "%s": 1' % (b"k" * MEGABYTE)),
    "__proto__": scene(rest=b', "__proto__": {}, "__class__": {}'),
}
TEXTS = {
    "a byte that is not UTF-8": scene(rest=b', "\xff": 1'),
    "an overlong slash": scene(rest=b', "\xc0\xaf": 1'),
    "half a character": scene(rest=b', "\xe2\x82'),
    "a surrogate in UTF-8": scene(rest=b', "\xed\xa0\x80": 1'),
    "a lone surrogate": sphere(rb'"name": "\ud800", "radius": 0'),
    "NUL in a name": sphere(rb'"name": "\u0000", "radius": 0'),
    "NUL bytes": bytes(1000),
    "UTF-16": scene().decode().encode("utf-16"),
    "a byte order mark": b"\xef\xbb\xbf" + scene(),
    "a control character in a string": scene(rest=b', "a\nb": 1'),
    "two documents": scene() + scene(),
    "nothing": b"",
    "white space": b" " * MEGABYTE,
    "an open string": b'"' + b"a" * MEGABYTE,
    "escapes without an end": b'"' + b"\\" * (MEGABYTE + 1),
    "a comment": b"/* */" + scene(),
    "a name that injects": scene(rest=rb', "a\r\nX-Evil: 1": 1'),
}
NAMED = {
    "an unknown scene": naming(b"x"),
    "a scene of a megabyte": naming(b"s" * MEGABYTE),
    "a scene that injects": naming(rb"\r\nX-Evil: 1"),
    "a scene that is a path": naming(b"../../etc/passwd"),
    "an array without arrays": sphere(b'"count": 2, "center": "@x"'),
    "an array that is a path": sphere(b'"count": 2, "center": "@../../etc/passwd"'),
}
REFUSED = (400, 413, 422)

CASES = [
    *(Hostile(name, render(body), REFUSED) for name, body in (TOO_MUCH | NUMBERS | NESTED | KEYS | TEXTS).items()),
    *(Hostile(name, render(body), (404, 422)) for name, body in NAMED.items()),
    Hostile("a count of 0", render(sphere(b'"count": 0')), (200,)),
    Hostile("zeros before an exponent", render(sphere(b'"radius": 0.%s1e1000000' % (b"0" * 1_000_000))), (200,)),
    Hostile("a name of a megabyte", render(sphere(b'"name": "%s"' % (b"n" * MEGABYTE))), (200,)),
    Hostile("a name with lines", render(sphere(rb'"name": "a\r\nX-Evil: 1"')), (200,)),
]
