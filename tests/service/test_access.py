"""Nobody gets in without a key where there are keys, no owner takes all, and no other page's script reads an answer."""

import asyncio
import hashlib
import re
from collections.abc import AsyncIterator
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest

from conicoid_service.access.gate import Gate
from conicoid_service.access.keys import Keys
from conicoid_service.guard import HEADERS
from tests.checkout import ROOT
from tests.service.conftest import FAKE, SCENE, named, serving, uncached
from tests.service.test_http import JSON, assert_problem

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("search_path")]

KEYS = Keys.parse(f"farm=first, farm=second nobody-else {'sha256:' + hashlib.sha256(b'hashed').hexdigest()}")
ROUTES = [
    ("GET", "/v1/device"), ("POST", "/v1/render"), ("POST", "/v1/canonical"), ("GET", "/v1/scenes/x"),
    ("GET", "/docs"), ("GET", "/openapi.json"), ("GET", "/nothing"), ("PATCH", "/v1/render"), ("GET", "/livez/"),
    ("GET", "//livez"),
]  # fmt: skip


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


@pytest.mark.parametrize(
    ("text", "owners"),
    [
        ("one", {"one": hashlib.sha256(b"one").hexdigest()[:12]}),
        ("a=one,b=two\n c-d_9=three", {"one": "a", "two": "b", "three": "c-d_9"}),
        ("a=one a=two", {"one": "a", "two": "a"}),
        (f"a=sha256:{hashlib.sha256(b'one').hexdigest().upper()}", {"one": "a"}),
        ("Zm9vYmFyYmF6cXV4Zm9vYg==", {"Zm9vYmFyYmF6cXV4Zm9vYg==": None}),
        ("m9vYmFyYmF6cXV4Zm9vYmE=", {"m9vYmFyYmF6cXV4Zm9vYmE=": None}),
        ("mmmmbmmmmmzmmm==", {"mmmmbmmmmmzmmm==": None, "=": "nobody", "": "nobody"}),
        ("a=mmmmbmmmmmzmmm==", {"mmmmbmmmmmzmmm==": "a"}),
        ("UPPER=key", {"UPPER=key": None, "key": "nobody"}),
    ],
)
def test_an_entry_is_a_key_with_or_without_a_name(text: str, owners: dict[str, str | None]) -> None:
    keys = Keys.parse(text)
    for key, owner in owners.items():
        expected = {None: hashlib.sha256(key.encode()).hexdigest()[:12], "nobody": None}.get(owner, owner)
        assert keys.owner_of(key.encode()) == expected


@pytest.mark.parametrize(
    "text", ["", " ,\n", "key\x7f", "kéy", "farm=", "farm==", "render-farm-of-workers=", "sha256:00",
             "a=sha256:" + "g" * 64, "one one", "a=one, b=one", f"one sha256:{hashlib.sha256(b'one').hexdigest()}"],
)  # fmt: skip
def test_a_malformed_list_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"entry"):
        Keys.parse(text)


def test_the_documented_example_lets_the_documented_request_in() -> None:
    page = (ROOT / "docs/security.md").read_text("utf-8")
    (value,), (key,) = (
        re.findall(r'CONICOID_API_KEYS="([^"]+)"', page),
        re.findall(r"Authorization: Bearer (\w+)\" ", page),
    )
    assert Keys.parse(value).owner_of(key.encode()) == "farm"


def test_a_key_itself_is_not_kept() -> None:
    assert "nobody-else" not in repr(vars(KEYS)) + "".join(repr(vars(entry)) for entry in KEYS.entries)


@pytest.fixture
async def locked() -> AsyncIterator[httpx.AsyncClient]:
    async with serving(uncached(api_keys=KEYS), FAKE) as client:
        yield client


async def test_every_route_but_the_probes_needs_a_key_before_the_body_is_read(locked: httpx.AsyncClient) -> None:
    read = []

    async def body() -> AsyncIterator[bytes]:
        read.append(1)
        yield b"{}"

    for method, path in ROUTES:
        response = await locked.request(method, path, content=body() if method == "POST" else None, headers=JSON)
        assert_problem(response, 401, "unauthorized")
        assert response.headers["www-authenticate"] == "Bearer"
    assert not read
    assert (await locked.get("/livez")).status_code == 200
    assert (await locked.get("/readyz")).status_code in (200, 503)


@pytest.mark.parametrize(
    "value",
    ["", "first", "Bearer", "Bearer ", "Bearer first second", "Bearer farm=first", "Basic first", "Bearer firs",
     "Bearer " + hashlib.sha256(b"first").hexdigest(), "Bearer sha256:" + hashlib.sha256(b"hashed").hexdigest(),
     "Bearer " + "x" * 60_000],
)  # fmt: skip
async def test_what_is_no_key_does_not_get_in(locked: httpx.AsyncClient, value: str) -> None:
    response = await locked.get("/v1/scenes/x", headers={"Authorization": value})
    assert_problem(response, 401, "unauthorized")
    assert "first" not in response.text


async def test_two_authorizations_are_none(locked: httpx.AsyncClient) -> None:
    both = [("Authorization", "Bearer first"), ("Authorization", "Bearer first")]
    assert_problem(await locked.get("/v1/scenes/x", headers=both), 401, "unauthorized")


@pytest.mark.parametrize("scheme", ["Bearer", "bearer", "BEARER "])
@pytest.mark.parametrize("key", ["first", "second", "nobody-else", "hashed"])
async def test_a_key_gets_in(locked: httpx.AsyncClient, scheme: str, key: str) -> None:
    response = await locked.get("/v1/scenes/x", headers={"Authorization": f"{scheme} {key}"})
    assert_problem(response, 404, "unknown-scene")


async def test_the_document_of_the_routes_declares_the_keys_where_there_are_any(locked: httpx.AsyncClient) -> None:
    document = (await locked.get("/openapi.json", headers=bearer("first"))).json()
    assert document["components"]["securitySchemes"]["key"]["scheme"] == "bearer"
    assert document["security"] == [{"key": []}]
    assert document["paths"]["/livez"]["get"]["security"] == []
    assert "security" not in document["paths"]["/v1/device"]["get"]
    assert {"401", "429"} <= document["paths"]["/v1/device"]["get"]["responses"].keys()
    async with serving(uncached(), FAKE) as client:
        assert "securitySchemes" not in (await client.get("/openapi.json")).json()["components"]


async def test_an_owner_has_so_many_requests_at_once_and_others_theirs(tmp_path: Path) -> None:
    go = tmp_path / "go"
    waiting = named(f"until {go}")
    async with serving(uncached(api_keys=KEYS, owner_requests=2), FAKE) as client:

        async def render(key: str) -> httpx.Response:
            return await client.post("/v1/render", json=waiting, headers=bearer(key))

        under_way = [asyncio.create_task(render(key)) for key in ("first", "second")]
        await asyncio.sleep(0.3)
        response = await client.get("/v1/scenes/x", headers=bearer("first"))
        assert_problem(response, 429, "quota")
        assert response.headers["retry-after"] == "1"
        assert_problem(await client.get("/v1/scenes/x", headers=bearer("hashed")), 404, "unknown-scene")
        assert (await client.get("/livez")).status_code == 200
        go.touch()
        assert [response.status_code for response in await asyncio.gather(*under_way)] == [200, 200]
        assert_problem(await client.get("/v1/scenes/x", headers=bearer("first")), 404, "unknown-scene")


async def test_the_routes_learn_who_asks() -> None:
    owners = []

    async def app(scope: dict[str, dict[str, str]], *_: object) -> None:
        owners.append(scope["state"]["owner"])

    async def ask(keys: Keys, path: str, authorization: bytes) -> None:
        scope = {"type": "http", "path": path, "headers": [(b"authorization", authorization)]}
        await Gate(app, keys, 1)(scope, None, None)  # type: ignore[arg-type]  # it needs neither

    await ask(KEYS, "/x", b"Bearer second")
    await ask(KEYS, "/x", b"Bearer nobody-else")
    await ask(KEYS, "/livez", b"Bearer second")
    await ask(Keys(), "/x", b"Bearer second")
    assert owners == ["farm", hashlib.sha256(b"nobody-else").hexdigest()[:12], "", ""]


async def test_a_job_is_its_owners_whichever_key_it_was_asked_with(locked: httpx.AsyncClient) -> None:
    job = (await locked.post("/v1/jobs", json=named("job"), headers=bearer("first"))).json()
    assert (await locked.get(job["href"], headers=bearer("second"))).status_code == 200
    assert_problem(await locked.get(job["href"], headers=bearer("hashed")), 404, "unknown-job")
    assert_problem(await locked.get(job["events"], headers=bearer("hashed")), 404, "unknown-job")
    assert_problem(await locked.delete(job["href"], headers=bearer("hashed")), 404, "unknown-job")
    assert (await locked.get("/v1/jobs", headers=bearer("hashed"))).json()["jobs"] == []


ORIGIN = {"Origin": "https://viewer.example"}
PREFLIGHT = ORIGIN | {"Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "authorization"}


async def test_no_answer_lets_another_pages_script_read_it_by_default(client: httpx.AsyncClient) -> None:
    for method, path in [*ROUTES, ("GET", "/livez"), ("OPTIONS", "/v1/render")]:
        headers = (await client.request(method, path, headers=PREFLIGHT | JSON)).headers
        assert not [name for name in headers if name.startswith("access-control")]


async def test_the_origins_that_are_set_may_ask_and_read_and_no_others() -> None:
    origins = ("https://viewer.example",)
    async with serving(uncached(api_keys=KEYS, cors_origins=origins), FAKE) as client:
        allowed = await client.options("/v1/render", headers=PREFLIGHT)
        assert (allowed.status_code, allowed.headers["access-control-allow-origin"]) == (200, origins[0])
        assert "access-control-allow-credentials" not in allowed.headers
        refused = await client.get("/v1/device", headers=ORIGIN)
        assert_problem(refused, 401, "unauthorized")
        assert refused.headers["access-control-allow-origin"] == origins[0]
        assert "ETag" in refused.headers["access-control-expose-headers"]
        other = PREFLIGHT | {"Origin": "https://other.example"}
        assert_problem(await client.options("/v1/render", headers=other), 400, "bad-request")
        assert "access-control-allow-origin" not in (await client.get("/livez", headers=other)).headers


async def test_every_answer_says_that_it_is_data(client: httpx.AsyncClient) -> None:
    for path in ("/livez", "/nothing", "/v1/device", "/openapi.json"):
        headers = (await client.get(path)).headers
        assert {name: headers[name] for name in HEADERS} == HEADERS


async def test_the_documentations_policy_lets_it_load_what_it_names_and_nothing_else(client: httpx.AsyncClient) -> None:
    response = await client.get("/docs")
    policy = dict(rule.split(" ", 1) for rule in response.headers["content-security-policy"].split("; "))
    assert policy["default-src"] == policy["frame-ancestors"] == "'none'"
    assert "unsafe" not in policy["script-src"]
    for pattern, kind in (
        (r"<script src=\"([^\"]+)", "script-src"),
        (r"rel=\"stylesheet\" href=\"([^\"]+)", "style-src"),
    ):
        (url,) = re.findall(pattern, response.text)
        assert f"https://{urlsplit(url).netloc}" in policy[kind].split()
    assert urlsplit(re.findall(r"url: '([^']+)'", response.text)[0]).netloc == ""
    assert len(re.findall("<script", response.text)) == 2


async def test_errors_tell_nothing_of_the_server(client: httpx.AsyncClient) -> None:
    answers = [
        await client.get("/nothing"),
        await client.put("/v1/render"),
        await client.get("/v1/scenes/" + "x" * 1000),
        await client.post("/v1/render", content=b"[", headers=JSON),
        await client.post("/v1/render", files={"scene": b"{}", "arrays": b"PK"}),
        await client.post("/v1/render", json=named("defect")),
    ]
    for answer in answers:
        assert answer.status_code >= 400
        assert not re.search(r"Traceback|\.py|site-packages|/usr|/tmp|secret", answer.text)
    assert (await client.post("/v1/render", json=SCENE)).status_code == 200
