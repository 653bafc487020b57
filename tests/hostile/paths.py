"""Paths, ids and queries that try to be something else."""

from tests.hostile.case import Hostile, request

IDS = [
    b"..", b"../../etc/passwd", b"..%2f..%2fetc%2fpasswd", b"%2e%2e/%2e%2e/etc/passwd", b"%252e%252e%252fetc", b"%00",
    b"a%00b", b"%0d%0aX-Evil:%201", b"%0aX-Evil:%201", b"%e5%98%8a%e5%98%8dX-Evil:1", b"%ff%fe", b"%c0%ae%c0%ae",
    b"%", b"%zz", b"%u0041", b"\xff\xfe", b"x" * 50_000, b"%41" * 15_000, b"..\\..\\etc", b"....//....//etc", b"~root",
    b"*", b"$(id)", b"`id`", b"' OR 1=1 --", b"{{7*7}}", b"<script>alert(1)</script>", b"\"><svg onload=1>", b"%s%s%n",
    b"AAAA%08x", b"file:///etc/passwd", b"http://evil.example/", b"//evil.example", b"x/", b"x//", b"./x", b";x=1",
]  # fmt: skip
PATHS = [
    b"//", b"///livez", b"/.", b"/..", b"/../../etc/passwd", b"/v1/../v1/device/x", b"/v1/render/..", b"/v1//render",
    b"/V1/RENDER", b"/docs/../../etc/passwd", b"/docs/oauth2-redirect", b"/redoc", b"/.env", b"/.git/config",
    b"/openapi.json/x", b"/livez%00", b"/livez%20", b"/%6civez%2f", b"/v1/render?" + b"a=b&" * 10_000,
    b"/v1/scenes", b"/v1/scenes/", b"/v1/jobs/../../x/y", b"/v1/device/../../../..",
]  # fmt: skip
REFUSED = (400, 404, 405)

CASES = [
    *(Hostile(f"get {one[:40]!r}", request(path=b"/v1/scenes/" + one), REFUSED) for one in IDS),
    *(Hostile(f"delete {one[:40]!r}", request(b"DELETE", b"/v1/scenes/" + one), REFUSED) for one in IDS),
    *(Hostile(f"path {path[:40]!r}", request(path=path), REFUSED) for path in PATHS),
    Hostile("a path that is a query", request(path=b"?x"), (400, 404)),
    Hostile("a path with a fragment", request(path=b"/livez#/v1"), (200, 400)),
]
