"""Bodies that are not of the type, encoding or length that they say."""

import gzip
import zlib

from tests.hostile.archives import archive
from tests.hostile.case import JSON, Hostile, multipart, part, render, request

SCENE = b'{"conicoid": 1, "quadrics": [], "camera": {"width": 4, "height": 4, "fov_y": 40}}'
GZIP = JSON + b"Content-Encoding: gzip\r\n"
END = b"--b--\r\n"


def gzip_bomb(size: int) -> bytes:
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    return b"".join([*(packer.compress(bytes(1 << 20)) for _ in range(size >> 20)), packer.flush()])


BOMB = gzip_bomb(1 << 30)
COMPRESSED = {
    "gzip of a gigabyte": (BOMB, 413),
    "gzip of gzip of a gigabyte": (gzip.compress(BOMB), 400),
    "gzip of many gigabytes": (gzip_bomb(1 << 26) * 90, 413),
    "100,000 empty members": (gzip.compress(b"") * 100_000, 400),
    "gzip cut short": (gzip.compress(SCENE)[:-3], 400),
    "gzip and rubbish": (gzip.compress(SCENE) + b"rubbish", 400),
    "gzip with a wrong checksum": (gzip.compress(SCENE)[:-8] + b"\1" * 8, 400),
    "no gzip": (SCENE, 400),
    "a gzip header alone": (gzip.compress(SCENE)[:10], 400),
    "a gzip name without an end": (b"\x1f\x8b\x08\x08" + bytes(6) + b"n" * (1 << 20), 400),
}
TYPES = {
    "no type": b"",
    "a type of a kilobyte": b"Content-Type: %s\r\n" % (b"x" * 1000),
    "a type that injects": b"Content-Type: a\tX-Evil: 1\r\n",
    "a type twice": b"Content-Type: text/plain\r\n" + JSON,
    "another character set": b"Content-Type: application/json; charset=utf-7\r\n",
    "multipart without a boundary": b"Content-Type: multipart/form-data\r\n",
    "a boundary too long": b"Content-Type: multipart/form-data; boundary=%s\r\n" % (b"b" * 1000),
    "a boundary in pieces": b"Content-Type: multipart/form-data; boundary*9999999999*=utf-8''%ff\r\n",
    "a boundary of bad bytes": b"Content-Type: multipart/form-data; boundary=\xff\xfe\r\n",
    "many parameters": b"Content-Type: multipart/form-data%s\r\n" % (b"; a=b" * 10_000),
    "open quotes": b'Content-Type: multipart/form-data; boundary="%s\r\n' % (b'\\"' * 20_000),
    "multipart of another kind": b"Content-Type: multipart/byteranges; boundary=b\r\n",
    "brotli": JSON + b"Content-Encoding: br\r\n",
    "gzip twice": JSON + b"Content-Encoding: gzip, gzip\r\n",
    "an encoding of a kilobyte": JSON + b"Content-Encoding: %s\r\n" % (b"x" * 1000),
}
PARTS = {
    "no parts": END,
    "no end": part(b"scene", SCENE),
    "nothing": b"",
    "a thousand parts": part(b"scene", SCENE) * 1000 + END,
    "a scene twice": part(b"scene", SCENE) * 2 + END,
    "arrays alone": part(b"arrays", archive([])) + END,
    "an unknown part": part(b"scene", SCENE) + part(b"x", b"") + END,
    "a part without headers": b"--b\r\n\r\n" + SCENE + b"\r\n" + END,
    "a part without a blank line": b"--b\r\nContent-Disposition: form-data; name=scene\r\n" + END,
    "a part with a megabyte of headers": b"--b\r\nX: %s\r\n\r\n\r\n" % (b"x" * (1 << 20)) + END,
    "a name that is a path": part(b"../../etc/passwd", SCENE) + END,
    "a name that injects": part(b"x\nX-Evil: 1", SCENE) + END,
    "a million boundaries": b"--b\r\n" * 1_000_000 + END,
    "an end in the beginning": END + part(b"scene", SCENE),
    "a name in many pieces": b"--b\r\nContent-Disposition: form-data%s\r\n\r\n\r\n"
    % b"".join(b"; name*%d*=x" % i for i in range(200)) + END,
}  # fmt: skip

CASES = [
    *(Hostile(f"body: {name}", render(body, GZIP), (status,)) for name, (body, status) in COMPRESSED.items()),
    *(Hostile(f"type: {name}", render(SCENE, headers), (415,)) for name, headers in TYPES.items()),
    *(Hostile(f"multipart: {name}", multipart(body), (400, 422)) for name, body in PARTS.items()),
    Hostile("a body over the limit", render(b" " * (9 << 20)), (413,)),
    Hostile(
        "a declared exabyte", request(b"POST", b"/v1/render", JSON + b"Content-Length: 1152921504606846976\r\n"), (413,)
    ),
    Hostile("a body with a GET", request(body=SCENE), (200,)),
    Hostile("a body for a route without one", request(b"DELETE", b"/v1/scenes/x", body=SCENE), (404,)),
]
