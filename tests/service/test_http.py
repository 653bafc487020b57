"""What the API promises on every route: media types, limits, tags, timings, problems."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import httpx
import jsonschema
import pytest

from conicoid import __version__
from conicoid_service.openapi import PROBLEM_SCHEMA
from tests.service.conftest import SCENE, named

pytestmark = pytest.mark.anyio

SCENE_ROUTES = ("/v1/render", "/v1/canonical")
JSON = {"Content-Type": "application/json"}


def assert_problem(response: httpx.Response, status: int, code: str) -> dict[str, Any]:
    """The response's problem document, which is as published and agrees with the status line."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document: dict[str, Any] = response.json()
    jsonschema.validate(document, PROBLEM_SCHEMA)
    assert (document["status"], document["code"]) == (status, code)
    return document


async def test_a_render_is_an_exr_image_with_its_tag_name_and_timing(client: httpx.AsyncClient) -> None:
    response = await client.post("/v1/render", json=SCENE)
    assert response.status_code == 200
    assert response.headers["content-type"] == "image/x-exr"
    assert response.content[:4] == bytes([0x76, 0x2F, 0x31, 0x01])  # OpenEXR's magic number
    assert int(response.headers["content-length"]) == len(response.content)
    assert response.headers["etag"].startswith('"')
    assert response.headers["content-disposition"].endswith('.exr"')
    assert (response.headers["conicoid-refined"], response.headers["conicoid-settled"]) == ("7", "4")  # the fake's own
    stages = dict(stage.split(";dur=") for stage in response.headers["server-timing"].split(", "))
    assert list(stages) == ["queue", "parse", "setup", "cast", "encode"]
    assert all(float(duration_ms) >= 0 for duration_ms in stages.values())
    assert float(stages["setup"]) > 1.0  # the fake's own 1 ms, and the document process' resolving and hashing


async def test_the_same_request_gives_the_same_bytes_and_tag(client: httpx.AsyncClient) -> None:
    first, second = [await client.post("/v1/render", json=SCENE) for _ in range(2)]
    assert first.content == second.content
    assert first.headers["etag"] == second.headers["etag"]


async def test_documents_that_mean_the_same_have_the_same_tag_and_others_another(client: httpx.AsyncClient) -> None:
    canonical = (await client.post("/v1/canonical", json=SCENE)).content
    other = SCENE | {"output": {"compression": "none"}}
    tags = [
        (await client.post("/v1/render", content=body, headers=JSON)).headers["etag"]
        if isinstance(body, bytes)
        else (await client.post("/v1/render", json=body)).headers["etag"]
        for body in (SCENE, canonical, other)
    ]
    assert tags[0] == tags[1] != tags[2]


@pytest.mark.parametrize("given", ["{}", "W/{}", '"other", {}', '"other",W/{},"more"', "*"])
async def test_a_client_that_has_the_image_is_told_so_without_rendering(client: httpx.AsyncClient, given: str) -> None:
    tag = (await client.post("/v1/render", json=SCENE)).headers["etag"]
    response = await client.post("/v1/render", json=SCENE, headers={"If-None-Match": given.format(tag)})
    assert response.status_code == 304
    assert response.content == b""
    assert response.headers["etag"] == tag
    assert "cast" not in response.headers["server-timing"]


@pytest.mark.parametrize("given", ['"other"', "other", "", "W/"])
async def test_a_client_that_has_another_image_gets_this_one(client: httpx.AsyncClient, given: str) -> None:
    response = await client.post("/v1/render", json=SCENE, headers={"If-None-Match": given})
    assert response.status_code == 200


async def test_canonical_form_is_its_own_canonical_form(client: httpx.AsyncClient) -> None:
    first = await client.post("/v1/canonical", json=SCENE)
    assert first.status_code == 200
    assert first.headers["content-type"] == "application/json"
    second = await client.post("/v1/canonical", content=first.content, headers=JSON)
    assert second.content == first.content


async def test_device_tells_what_renders_and_what_is_allowed(client: httpx.AsyncClient) -> None:
    device = (await client.get("/v1/device")).json()
    assert (device["platform"], device["device"]) == ("Fake", "none")
    assert device["version"] == __version__
    assert device["limits"] == {
        "body_bytes": 2_000_000,
        "quadrics": 100,
        "pixels": 5_000,
        "kept_bytes": 100_000,
        "queue": 32,
        "deadline_s": 60,
    }
    assert "exactly" in device["precision"]["exact"]
    assert "binary64" in device["precision"]["float64"]


async def test_probes_answer(client: httpx.AsyncClient) -> None:
    assert (await client.get("/livez")).json() == {"status": "alive"}
    await client.get("/v1/device")
    assert (await client.get("/readyz")).json()["status"] == "ready"


async def test_documentation_is_served_and_describes_the_scene(client: httpx.AsyncClient) -> None:
    document = (await client.get("/openapi.json")).json()
    body = document["paths"]["/v1/render"]["post"]["requestBody"]["content"]["application/json"]["schema"]
    assert body == {"$ref": "#/components/schemas/Scene"}
    jsonschema.Draft202012Validator(document["components"]["schemas"]["Scene"]).validate(SCENE)
    assert "text/html" in (await client.get("/docs")).headers["content-type"]


@pytest.mark.parametrize("path", ["/", "/v1", "/v1/render/", "/v1/nothing", "/v1/../etc/passwd"])
async def test_an_unknown_path_is_a_problem(client: httpx.AsyncClient, path: str) -> None:
    assert_problem(await client.get(path), 404, "not-found")


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("GET", "/v1/render", "POST"),
        ("PUT", "/v1/canonical", "POST"),
        ("POST", "/v1/device", "GET"),
        ("DELETE", "/readyz", "GET"),
        ("POST", "/livez", "GET"),
    ],
)
async def test_a_wrong_method_is_a_problem_that_names_the_right_one(
    client: httpx.AsyncClient, method: str, path: str, allowed: str
) -> None:
    response = await client.request(method, path)
    assert_problem(response, 405, "method-not-allowed")
    assert response.headers["allow"] == allowed


@pytest.mark.parametrize("method", ["POST", "DELETE"])
@pytest.mark.parametrize("path", ["/openapi.json", "/docs"])
async def test_a_wrong_method_on_the_documentation_is_a_problem_too(
    client: httpx.AsyncClient, method: str, path: str
) -> None:
    assert_problem(await client.request(method, path), 405, "method-not-allowed")


@pytest.mark.parametrize("path", SCENE_ROUTES)
@pytest.mark.parametrize(
    "media_type",
    [None, "", "text/plain", "multipart/form-data", "application/jsonp", "application/json; charset=latin-1"],
)
async def test_a_body_that_is_not_json_is_refused(client: httpx.AsyncClient, path: str, media_type: str | None) -> None:
    headers = {} if media_type is None else {"Content-Type": media_type}
    assert_problem(await client.post(path, content=b"{}", headers=headers), 415, "media-type")


@pytest.mark.parametrize("media_type", ["application/json", "Application/JSON", 'application/json; charset="UTF-8"'])
async def test_json_by_any_of_its_names_is_read(client: httpx.AsyncClient, media_type: str) -> None:
    canonical = (await client.post("/v1/canonical", json=SCENE)).content
    response = await client.post("/v1/canonical", content=canonical, headers={"Content-Type": media_type})
    assert response.status_code == 200


@pytest.mark.parametrize("encoding", ["br", "deflate", "gzip, gzip", "gzip, identity", ""])
async def test_a_body_that_is_compressed_otherwise_is_refused(client: httpx.AsyncClient, encoding: str) -> None:
    response = await client.post("/v1/render", content=b"{}", headers={**JSON, "Content-Encoding": encoding})
    assert_problem(response, 415, "content-encoding")
    assert response.headers["accept-encoding"] == "gzip"


@pytest.mark.parametrize("path", SCENE_ROUTES)
@pytest.mark.parametrize("body", [b"", b"{", b"[1,]", b'{"a": NaN', b"\xff\xfe", b"[" * 90_000])
async def test_a_body_that_is_not_json_at_all_is_a_problem(client: httpx.AsyncClient, path: str, body: bytes) -> None:
    assert_problem(await client.post(path, content=body, headers=JSON), 400, "scene-json")


@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_what_is_wrong_in_a_document_is_named_by_place(client: httpx.AsyncClient, path: str) -> None:
    scene = SCENE | {"quadrics": [{"shape": "sphere", "radius": -1}, {"shape": "sphere", "radius": "1"}]}
    problem = assert_problem(await client.post(path, json=scene), 422, "scene-value")
    assert [error["pointer"] for error in problem["errors"]] == ["quadrics[0].radius", "quadrics[1].radius"]
    assert "quadrics[0].radius: -1" in problem["detail"]


async def test_a_declared_length_beyond_the_limit_is_refused_before_the_body_is_read(client: httpx.AsyncClient) -> None:
    read = []

    async def body() -> AsyncIterator[bytes]:
        read.append(1)
        yield b"{}"

    headers = {**JSON, "Content-Length": "2000001"}
    response = await client.post("/v1/render", content=body(), headers=headers)
    problem = assert_problem(response, 413, "limit")
    assert (problem["limit"], problem["asked"]) == (2_000_000, 2_000_001)
    assert not read


async def test_a_chunked_body_is_refused_as_soon_as_it_passes_the_limit(client: httpx.AsyncClient) -> None:
    chunks = 0

    async def body() -> AsyncIterator[bytes]:
        nonlocal chunks
        for chunks in range(1, 1000):  # noqa: B007  # counted from outside
            yield b" " * 200_000

    response = await client.post("/v1/render", content=body(), headers=JSON)
    problem = assert_problem(response, 413, "limit")
    assert problem["limit"] == 2_000_000 < problem["asked"]
    assert chunks <= 12  # eleven pass the limit, one more may be on its way


@pytest.mark.parametrize("path", SCENE_ROUTES)
async def test_limits_of_work_are_refused_with_the_limit_and_the_cost(client: httpx.AsyncClient, path: str) -> None:
    many = SCENE | {"quadrics": SCENE["quadrics"] * 101}
    problem = assert_problem(await client.post(path, json=many), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (100, 101)
    large = SCENE | {"camera": SCENE["camera"] | {"width": 2**16, "height": 2**16}}
    problem = assert_problem(await client.post(path, json=large), 413, "limit")
    assert (problem["limit"], problem["asked"]) == (5_000, 2**32)


async def test_a_crop_of_a_large_image_costs_what_the_crop_costs(client: httpx.AsyncClient) -> None:
    cropped = SCENE | {
        "camera": SCENE["camera"] | {"width": 10_000, "height": 10_000, "crop": [5000, 5000, 5040, 5030]}
    }
    assert (await client.post("/v1/render", json=cropped)).status_code == 200


async def test_a_defect_in_the_render_process_tells_the_client_nothing_of_it(client: httpx.AsyncClient) -> None:
    response = await client.post("/v1/render", json=named("defect"))
    assert_problem(response, 500, "internal")
    assert "secret" not in response.text
    assert "Traceback" not in response.text


@pytest.mark.parametrize("path", ["/livez", "/nothing", "/v1/device", "/docs"])
async def test_every_response_has_the_security_headers(client: httpx.AsyncClient, path: str) -> None:
    headers = (await client.get(path)).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["x-frame-options"] == "DENY"
    assert headers["referrer-policy"] == "no-referrer"


async def test_requests_at_once_each_get_their_own_image(client: httpx.AsyncClient) -> None:
    scenes = [SCENE | {"camera": SCENE["camera"] | {"width": 10 + n}} for n in range(12)]
    alone = [(await client.post("/v1/render", json=scene)).content for scene in scenes]
    together = await asyncio.gather(*(client.post("/v1/render", json=scene) for scene in scenes))
    assert [response.content for response in together] == alone
    assert len(set(alone)) == len(alone)


async def test_a_wrong_method_names_the_methods_of_all_routes_of_its_path(client: httpx.AsyncClient) -> None:
    response = await client.put("/v1/jobs/1")
    assert_problem(response, 405, "method-not-allowed")
    assert response.headers["allow"] == "DELETE, GET"
