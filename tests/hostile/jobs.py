"""Batches that are too many, and headers and queries of jobs that are something else."""

from tests.hostile.case import JSON, Hostile, request

CAMERA = b'{"width": 4, "height": 4, "fov_y": 40}'
LARGE = b'{"width": 8000, "height": 8000, "fov_y": 40}'


def batch(cameras: bytes) -> bytes:
    return b'{"conicoid": 1, "quadrics": [], "cameras": %s}' % cameras


def submit(body: bytes, headers: bytes = b"") -> bytes:
    return request(b"POST", b"/v1/jobs", JSON + headers, body)


BATCHES = {
    "no cameras": batch(b"[]"),
    "one camera too many": batch(b"[%s]" % b",".join([CAMERA] * 10_001)),
    "150,000 cameras": batch(b"[%s]" % b",".join([CAMERA] * 150_000)),
    "pixels of all frames": batch(b"[%s]" % b",".join([LARGE] * 2000)),
    "one camera of a gigapixel": batch(b'[%s, {"width": 65536, "height": 65536, "fov_y": 40}]' % CAMERA),
    "cameras in cameras": batch(b"[" * 10_000 + b"]" * 10_000),
    "cameras that are none": batch(b"[%s]" % b",".join([b"0"] * 500_000)),
    "cameras and a camera": batch(b'[%s], "camera": %s' % (CAMERA, CAMERA)),
    "an unknown scene": b'{"conicoid": 1, "scene": "x", "cameras": [%s]}' % CAMERA,
}
KEYS = [b"x" * 256, b"y" * 60_000, b"\xff\xfe", b"a b", b"a\tX-Evil: 1", b"%0d%0aX-Evil: 1"]
PATHS = [
    b"?limit=-1", b"?limit=0", b"?limit=1e99", b"?limit=" + b"9" * 5000, b"?after=" + b"x" * 10_000,
    b"?state=x", b"?state=%0d%0aX-Evil:1", b"/x", b"/%00", b"/..", b"/%2e%2e%2fx",
    b"/x/frames/0", b"/x/frames/-1", b"/x/frames/" + b"9" * 5000, b"/x/frames/1e3", b"/x/frames/%2e%2e", b"/x/events",
    b"/x?first_frame=-1", b"/x?frame_limit=99999999999999999999", b"/" + b"x" * 10_000,
]  # fmt: skip
REFUSED = (400, 404, 405, 413, 422)

CASES = [
    *(Hostile(f"job: {name}", submit(body), REFUSED) for name, body in BATCHES.items()),
    *(
        Hostile(f"idempotency key {key[:20]!r}", submit(batch(b"[]"), b"Idempotency-Key: %s\r\n" % key), REFUSED)
        for key in KEYS
    ),
    *(Hostile(f"jobs{path[:40].decode()}", request(path=b"/v1/jobs" + path), REFUSED) for path in PATHS),
    *(Hostile(f"cancel{path[:40].decode()}", request(b"DELETE", b"/v1/jobs" + path), REFUSED) for path in PATHS[7:11]),
    Hostile("an event id of nonsense", request(path=b"/v1/jobs/x/events", headers=b"Last-Event-ID: -1e9\r\n"), REFUSED),
    Hostile("a cursor with NUL", request(path=b"/v1/jobs?after=%00"), (200, 422)),
    Hostile("a cursor of SQL", request(path=b"/v1/jobs?after=%27%20OR%201%3D1%20--"), (200, 422)),
]
