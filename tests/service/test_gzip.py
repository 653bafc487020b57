"""A gzip body means what it inflates to, and costs no more than the limit allows."""

import gzip
import tracemalloc
import zlib
from typing import Any

import httpx
import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid_service.access.gzip_stream import GzipStream
from conicoid_service.errors import CompressedDataError
from tests.service.conftest import SCENE
from tests.service.test_http import JSON, SCENE_ROUTES, assert_problem

GZIP = {**JSON, "Content-Encoding": "gzip"}
PLAIN = orjson.dumps(SCENE)
WHOLE = gzip.compress(PLAIN)


def inflated(*chunks: bytes) -> list[bytes]:
    """A whole body's pieces."""
    stream = GzipStream()
    pieces = [piece for chunk in chunks for piece in stream.inflate(chunk)]
    stream.finish()
    return pieces


@given(st.lists(st.binary(max_size=3000), min_size=1, max_size=4), st.integers(1, 4000))
def test_members_inflate_to_what_was_compressed_however_they_are_cut(contents: list[bytes], size: int) -> None:
    data = b"".join(gzip.compress(content) for content in contents)
    pieces = inflated(*(data[start : start + size] for start in range(0, len(data), size)))
    assert b"".join(pieces) == b"".join(contents)
    assert all(pieces)


@given(st.integers(0, len(WHOLE) - 1))
def test_a_body_that_is_cut_short_anywhere_is_refused(length: int) -> None:
    with pytest.raises(CompressedDataError):
        inflated(WHOLE[:length])


@given(st.binary(max_size=50), st.binary(min_size=1, max_size=50))
def test_what_is_not_gzip_is_refused(before: bytes, after: bytes) -> None:
    for data in (before, WHOLE + after):
        with pytest.raises(CompressedDataError):
            inflated(data)


def test_a_bomb_is_inflated_a_piece_at_a_time() -> None:
    bomb = gzip.compress(bytes(1 << 28))
    tracemalloc.start()
    for piece in GzipStream().inflate(bomb):
        assert len(piece) <= 1 << 20
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 16 << 20


@pytest.mark.anyio
@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_a_compressed_document_is_answered_as_the_plain_one(client: httpx.AsyncClient, path: str) -> None:
    plain = await client.post(path, content=PLAIN, headers=JSON)
    for encoding in ("gzip", "x-gzip", "GZIP"):
        answer = await client.post(path, content=WHOLE, headers={**JSON, "Content-Encoding": encoding})
        assert (answer.status_code, answer.content) == (200, plain.content)
        assert answer.headers.get("etag") == plain.headers.get("etag")


@pytest.mark.anyio
async def test_a_compressed_multipart_body_is_read_too(client: httpx.AsyncClient) -> None:
    request = client.build_request("POST", "/v1/canonical", files={"scene": PLAIN})
    body = gzip.compress(b"".join([chunk async for chunk in request.stream]))  # type: ignore[union-attr]
    headers = {"Content-Type": request.headers["content-type"], "Content-Encoding": "gzip"}
    assert (await client.post("/v1/canonical", content=body, headers=headers)).status_code == 200


def deflate_bomb(size: int, wbits: int) -> bytes:
    """Zeros, compressed a piece at a time."""
    packer = zlib.compressobj(9, zlib.DEFLATED, wbits)
    pieces = [packer.compress(bytes(1 << 20)) for _ in range(size >> 20)]
    return b"".join([*pieces, packer.flush()])


@pytest.mark.anyio
@pytest.mark.parametrize(
    ("body", "status", "code"),
    [
        (b"", 400, "content-encoding-data"),
        (b"{}", 400, "content-encoding-data"),
        (PLAIN, 400, "content-encoding-data"),
        (WHOLE[:-1], 400, "content-encoding-data"),
        (WHOLE[:-8] + bytes(8), 400, "content-encoding-data"),
        (WHOLE + b"\0", 400, "content-encoding-data"),
        (zlib.compress(PLAIN), 400, "content-encoding-data"),
        (gzip.compress(WHOLE), 400, "scene-json"),
        (gzip.compress(b""), 400, "scene-json"),
        (deflate_bomb(64 << 20, 31), 413, "limit"),
        (deflate_bomb(2 << 20, 31) * 1000, 413, "limit"),
    ],
)
async def test_a_body_that_lies_is_refused(client: httpx.AsyncClient, body: bytes, status: int, code: str) -> None:
    problem: dict[str, Any] = assert_problem(await client.post("/v1/render", content=body, headers=GZIP), status, code)
    if status == 413:
        assert problem["limit"] == 2_000_000 < problem["asked"] <= 2_000_000 + (1 << 20)
