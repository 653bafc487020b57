"""What is not quite HTTP, or HTTP that two servers would read differently."""

from tests.hostile.case import CLOSE, JSON, Hostile, request

GET = b"GET /livez HTTP/1.1\r\nHost: x\r\n"
POST = b"POST /v1/canonical HTTP/1.1\r\nHost: x\r\n" + CLOSE + JSON
CHUNKED = POST + b"Transfer-Encoding: chunked\r\n\r\n"
SMUGGLED = b"GET /v1/device HTTP/1.1\r\nHost: x\r\nX-Evil: 1\r\n\r\n"

# Nobody who sends these can count on an answer; one that comes is a refusal.
GARBAGE = {
    "TLS": b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(256)),
    "SSH": b"SSH-2.0-OpenSSH_9.2\r\n",
    "HTTP/2": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    "HTTP/9.9": b"GET /livez HTTP/9.9\r\n\r\n",
    "HTTP/1.1.1": b"GET /livez HTTP/1.1.1\r\n\r\n",
    "no path": b"GET HTTP/1.1\r\nHost: x\r\n\r\n",
    "NUL bytes": bytes(1000),
    "random bytes": bytes(range(255, 127, -1)) * 50,
    "a megabyte without a line": b"A" * (1 << 20),
    "an unknown method": b"EVIL /livez HTTP/1.1\r\nHost: x\r\n\r\n",
    "a method of a kilobyte": b"G" * 1000 + b" /livez HTTP/1.1\r\n\r\n",
    "a method in small letters": b"get /livez HTTP/1.1\r\nHost: x\r\n\r\n",
    "a tab for a space": b"GET\t/livez\tHTTP/1.1\r\nHost: x\r\n\r\n",
    "NUL in a path": b"GET /livez\0/x HTTP/1.1\r\nHost: x\r\n\r\n",
    "NUL in a header": GET + b"X: a\0b\r\n\r\n",
    "a space before a colon": GET + b"X-Evil : 1\r\n\r\n",
    "a header without a colon": GET + b"X-Evil\r\n\r\n",
    "a header without a name": GET + b": 1\r\n\r\n",
    "a return alone": GET + b"X: a\rX-Evil: 1\r\n\r\n",
    "a control character in a header's name": GET + b"X\x01: 1\r\n\r\n",
    "a header's name of bad bytes": GET + b"\xff\xfe: 1\r\n\r\n",
    "64 kilobytes of header": GET + b"X: " + b"x" * (1 << 17) + b"\r\n\r\n",
    "50,000 headers": GET + b"X: 1\r\n" * 50_000 + b"\r\n",
    "64 kilobytes of path": b"GET /" + b"x" * (1 << 17) + b" HTTP/1.1\r\nHost: x\r\n\r\n",
    "two lengths": POST + b"Content-Length: 2\r\nContent-Length: 3\r\n\r\n{}x",
    "a negative length": POST + b"Content-Length: -1\r\n\r\n{}",
    "a length with a sign": POST + b"Content-Length: +2\r\n\r\n{}",
    "a length of letters": POST + b"Content-Length: two\r\n\r\n{}",
    "a length of hexadecimal": POST + b"Content-Length: 0x2\r\n\r\n{}",
    "a length beyond 64 bits": POST + b"Content-Length: 99999999999999999999999\r\n\r\n{}",
    "a list of lengths": POST + b"Content-Length: 2, 2\r\n\r\n{}",
    "a length and chunks": POST + b"Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n" + SMUGGLED,
    "chunks and a length": POST + b"Transfer-Encoding: chunked\r\nContent-Length: 2\r\n\r\n0\r\n\r\n" + SMUGGLED,
    "chunked and another": POST + b"Transfer-Encoding: chunked, gzip\r\n\r\n0\r\n\r\n",
    "chunked by another name": POST + b"Transfer-Encoding: xchunked\r\n\r\n0\r\n\r\n",
    "a chunk's size of letters": CHUNKED + b"xyz\r\n{}\r\n0\r\n\r\n",
    "a chunk's size below 0": CHUNKED + b"-2\r\n{}\r\n0\r\n\r\n",
    "a chunk's size beyond 64 bits": CHUNKED + b"fffffffffffffffff\r\n{}\r\n0\r\n\r\n",
    "a chunk longer than its size": CHUNKED + b"1\r\n{}\r\n0\r\n\r\n",
    "a chunk shorter than its size": CHUNKED + b"5\r\n{}\r\n0\r\n\r\n",
    "a chunk without a size": CHUNKED + b"\r\n{}\r\n0\r\n\r\n",
    "a trailer without an end": CHUNKED + b"2\r\n{}\r\n0\r\nX: " + b"x" * (1 << 17),
    "an extension without an end": CHUNKED + b"2;" + b"x" * (1 << 17),
}
TIMED = {
    "half a head": (GET, 408),
    "half a line": (b"GET /li", 408),
    "lines alone": (b"\r\n" * 100, 408),
    "no body": (POST + b"Content-Length: 10\r\n\r\n", 408),
    "half a body": (POST + b"Content-Length: 10\r\n\r\n{}", 408),
    "half a chunk": (CHUNKED + b"a\r\n{}", 408),
    "no last chunk": (CHUNKED + b"2\r\n{}\r\n", 408),
    "no end of a trailer": (CHUNKED + b"2\r\n{}\r\n0\r\nX: 1\r\n", 408),
    "a body after 100-continue that does not come": (POST + b"Expect: 100-continue\r\nContent-Length: 2\r\n\r\n", 408),
}
ANSWERED = {
    "more body than its length": (POST + b"Content-Length: 2\r\n\r\n{}" + b"{}" * 100, (400, 422)),
    "a request behind a request": (POST + b"Content-Length: 2\r\n\r\n{}" + SMUGGLED, (400, 422)),
    "a thousand requests at once": (request(headers=b"X: 1\r\n") + (GET + b"\r\n") * 1000, (200,)),
    "a folded header": (GET + CLOSE + b"X: 1\r\n X-Evil: 1\r\n\r\n", (200, 400)),
    "a line feed alone": (GET + CLOSE + b"X: a\nY: 1\r\n\r\n", (200, 400)),
    "HTTP/0.9": (b"GET /livez\r\n\r\n", (200, 400)),
    "HTTP/1.0": (b"GET /livez HTTP/1.0\r\n\r\n", (200,)),
    "HTTP/1.0 with chunks": (CHUNKED.replace(b"HTTP/1.1", b"HTTP/1.0") + b"2\r\n{}\r\n0\r\n\r\n", (200, 400, 422)),
    "HTTP/1.0 without a length": (b"POST /v1/render HTTP/1.0\r\n" + JSON + b"\r\n{}", (400,)),
    "no host": (b"GET /livez HTTP/1.1\r\n" + CLOSE + b"\r\n", (200, 400)),
    "two hosts": (GET + CLOSE + b"Host: y\r\n\r\n", (200, 400)),
    "an upgrade to websocket": (
        GET
        + b"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Key: eA==\r\nSec-WebSocket-Version: 13\r\n\r\n",
        (200, 400, 426),
    ),
    "an upgrade to HTTP/2": (GET + b"Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\n\r\n", (200, 400)),
    "an expectation of nonsense": (GET + CLOSE + b"Expect: nonsense\r\n\r\n", (200, 417)),
    "an address for a path": (b"GET http://evil.example/livez HTTP/1.1\r\nHost: x\r\n" + CLOSE + b"\r\n", (200, 400)),
    "an authority for a path": (b"CONNECT evil.example:443 HTTP/1.1\r\nHost: x\r\n" + CLOSE + b"\r\n", (400, 404, 405)),
    "a star for a path": (b"OPTIONS * HTTP/1.1\r\nHost: x\r\n" + CLOSE + b"\r\n", (200, 400, 404, 405)),
    "ranges": (GET + CLOSE + b"Range: bytes=%s\r\n\r\n" % (b"0-1," * 10_000), (200,)),
    "a tag of 50 kilobytes": (GET + CLOSE + b"If-None-Match: %s\r\n\r\n" % (b'"x",' * 12_000), (200,)),
    "bad bytes in a header": (GET + CLOSE + b"If-None-Match: \xff\xfe\r\nAuthorization: Bearer \xff\r\n\r\n", (200,)),
}
HOSTS = [b"", b"[::1", b"x:99999999", b"evil.example/path", b"a b", b"x@y", b"\xff", b"%0d%0aX-Evil:1", b"x" * 10_000]
METHODS = [b"HEAD", b"PUT", b"PATCH", b"TRACE", b"OPTIONS", b"PROPFIND", b"PURGE", b"M-SEARCH", b"QUERY"]

CASES = [
    *(Hostile(f"no HTTP: {name}", sent, (400, 408, 413, 414, 415, 422, 431)) for name, sent in GARBAGE.items()),
    *(Hostile(f"unfinished: {name}", sent, (status,)) for name, (sent, status) in TIMED.items()),
    *(Hostile(f"odd: {name}", sent, statuses) for name, (sent, statuses) in ANSWERED.items()),
    *(Hostile(f"host: {host[:20]!r}", request(host=host), (200, 400)) for host in HOSTS),
    *(Hostile(f"method: {method.decode()}", request(method, b"/v1/render"), (400, 405)) for method in METHODS),
]
