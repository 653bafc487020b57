"""A document and its arrays in one body: multipart/form-data, found in its file without taking it apart."""

import io
import json
import zipfile
from typing import Any

import httpx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid_service.blob import Blob
from conicoid_service.errors import MultipartError
from conicoid_service.multipart import boundary_of, parts_of
from tests.malformed import npz
from tests.service.conftest import SCENE
from tests.service.test_http import SCENE_ROUTES, assert_problem

pytestmark = pytest.mark.anyio

SET: dict[str, Any] = SCENE | {"quadrics": [{"shape": "sphere", "count": 2, "radius": "@r", "center": [0, 0, -3]}]}
LISTS: dict[str, Any] = SCENE | {"quadrics": [{"shape": "sphere", "count": 2, "radius": [1, 2], "center": [0, 0, -3]}]}
MANY = "multipart/form-data; boundary=b"


def saved(**arrays: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def upload(scene: Any = SET, **parts: bytes) -> dict[str, Any]:
    return {"scene": json.dumps(scene), **parts}


def joined(parts: dict[str, bytes], boundary: str = "b") -> bytes:
    """A body as RFC 7578 has it."""
    pieces = [
        f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"\r\n\r\n'.encode() + content + b"\r\n"
        for name, content in parts.items()
    ]
    return b"".join(pieces) + f"--{boundary}--\r\n".encode()


def taken(body: bytes, boundary: str = "b") -> dict[str, bytes]:
    with Blob.of(body) as blob:
        return {name: part.read() for name, part in parts_of(blob.fileno(), boundary).items()}


@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_arrays_beside_a_document_are_as_good_as_lists_in_it(client: httpx.AsyncClient, path: str) -> None:
    uploaded = await client.post(path, files=upload(arrays=saved(r=np.array([1.0, 2.0]))))
    listed = await client.post(path, json=LISTS)
    assert uploaded.status_code == 200, uploaded.text
    assert uploaded.content == listed.content
    assert uploaded.headers.get("etag") == listed.headers.get("etag")


@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_a_document_may_come_alone_in_parts(client: httpx.AsyncClient, path: str) -> None:
    uploaded = await client.post(path, files=upload(SCENE))
    assert uploaded.content == (await client.post(path, json=SCENE)).content


@pytest.mark.parametrize("path", SCENE_ROUTES)
@pytest.mark.parametrize(
    "parts",
    [
        {"arrays": b"x"},
        {"document": b"{}"},
        {"scene": b"{}", "more": b""},
        {"scene": b"{}", "arrays": b"", "other": b""},
    ],
)
async def test_other_parts_are_refused(client: httpx.AsyncClient, path: str, parts: dict[str, bytes]) -> None:
    problem = assert_problem(await client.post(path, files=parts), 400, "multipart")
    assert "a JSON part named scene" in problem["detail"]


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"--b--",
        b"{}",
        joined({"scene": b"{}"}).removesuffix(b"--\r\n"),
        joined({"scene": b"{}"})[:-6],
        joined({"scene": b"{}"}, "other"),
        joined({"scene": b"{}"}).replace(b"Content-Disposition", b"Content-Type"),
        joined({"scene": b"{}"}).replace(b'name="scene"', b"name"),
        joined({"scene": b"{}"}).replace(b'name="scene"', b"name*=utf-8''scene"),
        joined({"scene": b"{}"}).replace(b"\r\n\r\n", b"\r\n"),
        joined({"scene": b"{}"}).replace(b"--b\r\n", b"--bc\r\n"),
        joined({"scene": b"{}"}).replace(b"form-data;", b"form-data; x=" + b"y" * 5000 + b";"),
        joined({"scene": b"{}"}) + joined({"scene": b"{}"}),
        joined({"scene": b"{}"}).removesuffix(b"--b--\r\n") + joined({"scene": b"{}"}),
        joined({f"part{i}": b"" for i in range(1000)}),
    ],
)
async def test_a_body_that_is_not_in_such_parts_is_refused(client: httpx.AsyncClient, body: bytes) -> None:
    response = await client.post("/v1/canonical", content=body, headers={"Content-Type": MANY})
    assert_problem(response, 400, "multipart")


@pytest.mark.parametrize(
    "media_type",
    [
        "multipart/form-data; boundary=",
        'multipart/form-data; boundary=""',
        f"multipart/form-data; boundary={'b' * 71}",
        "multipart/form-data; boundary=\xe4",
        "multipart/mixed; boundary=b",
    ],
)
async def test_a_type_without_a_usable_boundary_is_refused(client: httpx.AsyncClient, media_type: str) -> None:
    headers = httpx.Headers({b"Content-Type": media_type.encode("latin-1")})
    response = await client.post("/v1/canonical", content=joined({"scene": b"{}"}), headers=headers)
    assert_problem(response, 415, "media-type")


async def test_arrays_are_limited_by_what_they_inflate_to(client: httpx.AsyncClient) -> None:
    member = npz.npy(np.zeros(300_000))
    bomb = npz.npz(("r.npy", member), method=zipfile.ZIP_DEFLATED)
    problem = assert_problem(await client.post("/v1/render", files=upload(arrays=bomb)), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (2_000_000, len(member))


async def test_the_quadrics_of_sets_are_limited_before_their_arrays_matter(client: httpx.AsyncClient) -> None:
    many = SCENE | {"quadrics": [{"shape": "sphere", "count": 4_000_000_000}]}
    problem = assert_problem(await client.post("/v1/render", json=many), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (100, 4_000_000_000)


async def test_the_openapi_document_has_both_kinds_of_body(client: httpx.AsyncClient) -> None:
    paths = (await client.get("/openapi.json")).json()["paths"]
    for path in SCENE_ROUTES:
        content = paths[path]["post"]["requestBody"]["content"]
        assert list(content) == ["application/json", "multipart/form-data"]
        assert list(content["multipart/form-data"]["schema"]["properties"]) == ["scene", "arrays"]


contents = st.binary(max_size=50) | st.lists(st.sampled_from([b"\r\n", b"--", b"-", b"\r", b"\n", b"b"])).map(b"".join)


@given(st.dictionaries(st.sampled_from(["scene", "arrays", "a1", "_"]), contents))
def test_every_part_is_found_whole(parts: dict[str, bytes]) -> None:
    boundary = "==b=b=="  # in none of the contents
    found = taken(b"preamble\r\n" + joined(parts, boundary) + b"epilogue", boundary) if parts else {}
    assert found == parts


def test_a_delimiter_across_pieces_of_the_body_is_found() -> None:
    piece = 1 << 20
    for short in range(40, 70):  # the delimiter is some 55 bytes after so much content
        parts = {"scene": b"x" * (piece - short), "arrays": b"y"}
        assert taken(joined(parts)) == parts


@given(st.binary(max_size=80) | st.lists(st.sampled_from([b"--b", b"\r\n", b"--", b": ", b"x"])).map(b"".join))
def test_any_body_is_parts_or_refused(body: bytes) -> None:
    for whole in (body, joined({"scene": body}), b"--b\r\nContent-Disposition: form-data;" + body + b"\r\n--b--"):
        try:
            taken(whole)
        except MultipartError as error:
            str(error).encode()


@given(st.text(st.characters(max_codepoint=255), max_size=40))
def test_any_content_type_has_a_boundary_or_none(text: str) -> None:
    for content_type in (text, f"multipart/form-data;{text}", f"multipart/form-data; boundary{text}"):
        boundary = boundary_of(content_type)
        assert boundary is None or (boundary.isascii() and 0 < len(boundary) <= 70)


@pytest.mark.parametrize("given", ["b", '"b"', 'b; charset="utf-8"'])
def test_a_boundary_may_be_quoted(given: str) -> None:
    assert boundary_of(f"Multipart/Form-Data; boundary={given}") == "b"


@given(st.data())
def test_a_part_is_a_file_of_its_own(data: st.DataObject) -> None:
    content = b"0123456789"
    body = joined({"scene": content})
    with Blob.of(body) as blob:
        part, model = parts_of(blob.fileno(), "b")["scene"], io.BytesIO(content)
        for _ in range(data.draw(st.integers(1, 6))):
            offset, whence = data.draw(st.integers(-10, 10)), data.draw(st.sampled_from([0, 1, 2]))
            if not 0 <= (0, part.tell(), len(content))[whence] + offset <= len(content):
                continue
            assert part.seek(offset, whence) == model.seek(offset, whence)
            size = data.draw(st.integers(-1, 12))
            assert part.read(size) == model.read(size)


def test_there_is_nothing_before_a_part() -> None:
    with Blob.of(joined({"scene": b"{}"})) as blob:
        part = parts_of(blob.fileno(), "b")["scene"]
        with pytest.raises(ValueError, match="before the start"):
            part.seek(-1)
