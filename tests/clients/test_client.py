"""The client library against answers made up here."""

import io
import json
import re
from collections.abc import Callable, Mapping

import httpx
import numpy as np
import pytest

import conicoid_client
from conicoid_client import Client, ClientError, Problem, ProblemError, SceneRejected, ServerBusy, Unreachable

Handler = Callable[[httpx.Request], httpx.Response]


def client(handler: Handler, retries: int = 4) -> Client:
    return Client("http://service.test", transport=httpx.MockTransport(handler), retries=retries)


def problem(status: int, **members: object) -> httpx.Response:
    headers = {"Content-Type": "application/problem+json"}
    return httpx.Response(status, headers=headers, content=json.dumps({"status": status, **members}))


def exr(content: bytes = b"", headers: Mapping[str, str] | None = None) -> httpx.Response:
    return httpx.Response(200, content=content, headers={"Content-Type": "image/x-exr", **(headers or {})})


@pytest.fixture
def naps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The waits that were asked for; none of them is waited."""
    slept: list[float] = []
    monkeypatch.setattr("conicoid_client.connection.time.sleep", slept.append)
    return slept


def test_render_sends_the_text_as_it_is_and_reads_what_comes_back() -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        assert (request.method, request.url.path) == ("POST", "/v1/render")
        assert request.headers["Content-Type"] == "application/json"
        assert request.content == b'{"conicoid":  1}'
        return exr(
            b"exr",
            {"ETag": '"tag"', "Server-Timing": "cast;dur=4.1, encode;dur=97, odd;desc=x", "Conicoid-Settled": "3"},
        )

    rendering = client(answer).render(b'{"conicoid":  1}')
    assert (rendering.exr, rendering.etag) == (b"exr", '"tag"')
    assert rendering.timing_ms == {"cast": 4.1, "encode": 97.0}
    assert rendering.settled == 3
    assert client(lambda _: exr()).render(b"{}").settled is None


def test_a_mapping_is_sent_as_json_with_the_precision_asked_for() -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        assert json.loads(request.content) == {"conicoid": 1, "output": {"precision": "float32"}}
        return exr()

    client(answer).render({"conicoid": 1}, precision="float32")


def test_not_a_number_is_refused_before_it_is_sent() -> None:
    with pytest.raises(ValueError, match="JSON"):
        client(lambda _: exr()).render({"conicoid": float("nan")})


def test_a_rendering_that_is_still_current_is_none() -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        return httpx.Response(304) if request.headers.get("If-None-Match") == '"tag"' else exr(b"new")

    assert client(answer).render(b"{}", etag='"tag"') is None
    changed = client(answer).render(b"{}", etag='"other"')
    assert changed is not None
    assert changed.exr == b"new"


def test_a_rejected_scene_names_every_place() -> None:
    errors = [
        {"pointer": "quadrics[3].radius", "message": "-1 is not > 0; give a positive radius", "code": "scene-value"},
        {"pointer": "", "message": "no camera"},
    ]
    with pytest.raises(SceneRejected) as caught:
        client(lambda _: problem(422, code="scene-value", detail="2 problems", errors=errors)).canonical(b"{}")
    assert caught.value.problems == (
        Problem("quadrics[3].radius", "-1 is not > 0; give a positive radius", "scene-value"),
        Problem("", "no camera", ""),
    )
    assert "quadrics[3].radius: -1 is not > 0; give a positive radius [scene-value]" in str(caught.value)


@pytest.mark.parametrize("status", [400, 413, 415, 422])
def test_what_the_document_is_to_blame_for_is_a_rejected_scene(status: int) -> None:
    with pytest.raises(SceneRejected):
        client(lambda _: problem(status)).render(b"{}")


@pytest.mark.parametrize("status", [301, 401, 404, 405, 500, 502, 504])
def test_any_other_error_is_not_blamed_on_the_scene(status: int) -> None:
    with pytest.raises(ProblemError) as caught:
        client(lambda _: problem(status, code="c", detail="d")).render(b"{}")
    assert not isinstance(caught.value, SceneRejected)
    assert (caught.value.status, caught.value.code, caught.value.detail) == (status, "c", "d")


@pytest.mark.parametrize("body", [b"", b"<html>", b"[]", b'"text"', b'{"errors": 3}', b'{"errors": [1, {}]}'])
def test_an_error_that_is_not_problem_json_is_still_readable(body: bytes) -> None:
    with pytest.raises(ProblemError) as caught:
        client(lambda _: httpx.Response(502, content=body)).device()
    assert caught.value.code == "http-502"
    assert "502 Bad Gateway" in caught.value.detail


@pytest.mark.parametrize("status", [429, 503])
def test_a_busy_service_is_asked_again_when_it_says_so(status: int, naps: list[float]) -> None:
    answers = iter([problem(status), exr(b"exr")])
    first = next(answers)
    first.headers["Retry-After"] = "3"
    remaining = iter([first, *answers])
    assert client(lambda _: next(remaining)).render(b"{}").exr == b"exr"
    assert naps == [3.0]


def test_a_service_that_stays_busy_is_given_up_after_the_retries(naps: list[float]) -> None:
    def answer(_: httpx.Request) -> httpx.Response:
        busy = problem(429, code="queue-full", detail="the queue is full")
        busy.headers["Retry-After"] = "0.5"
        return busy

    with pytest.raises(ServerBusy, match="queue-full") as caught:
        client(answer, retries=2).render(b"{}")
    assert naps == [0.5, 0.5]
    assert caught.value.retry_after == 0.5


@pytest.mark.parametrize("retry_after", [None, "Wed, 21 Oct 2026 07:28:00 GMT", "86400"])
def test_without_a_short_wait_in_seconds_a_busy_service_fails_at_once(
    retry_after: str | None, naps: list[float]
) -> None:
    headers = {} if retry_after is None else {"Retry-After": retry_after}
    with pytest.raises(ServerBusy):
        client(lambda _: httpx.Response(503, headers=headers)).render(b"{}")
    assert naps == []


def test_other_errors_are_not_repeated(naps: list[float]) -> None:
    with pytest.raises(ProblemError):
        client(lambda _: httpx.Response(500, headers={"Retry-After": "1"})).render(b"{}")
    assert naps == []


@pytest.mark.parametrize(
    "error", [httpx.ConnectError("refused"), httpx.ReadTimeout(""), httpx.RemoteProtocolError("cut")]
)
def test_no_answer_is_unreachable_and_says_where(error: httpx.HTTPError, naps: list[float]) -> None:
    def answer(_: httpx.Request) -> httpx.Response:
        raise error

    with pytest.raises(Unreachable, match=r"http://service\.test.*: .+"):
        client(answer).device()
    assert sum(naps) <= 2


@pytest.mark.parametrize("url", ["", "localhost:8000", "ftp://host", "http://", "http://host:port"])
def test_an_address_that_is_not_one_is_refused_at_once(url: str) -> None:
    with pytest.raises(ClientError, match="URL"):
        Client(url)


@pytest.mark.parametrize("headers", [{}, {"Content-Type": "text/html; charset=utf-8"}])
def test_a_server_that_is_something_else_is_not_taken_for_conicoid(headers: dict[str, str]) -> None:
    other = client(lambda _: httpx.Response(200, content=b"<html>", headers=headers))
    for call in (lambda: other.render(b"{}"), lambda: other.canonical(b"{}"), other.device):
        with pytest.raises(ProblemError, match="is this a Conicoid service"):
            call()


def test_the_package_offers_what_it_names_and_nothing_else() -> None:
    assert all(getattr(conicoid_client, name).__name__ == name for name in conicoid_client.__all__)
    with pytest.raises(AttributeError, match="Clinet"):
        conicoid_client.Clinet  # noqa: B018


def parts(request: httpx.Request) -> dict[bytes, bytes]:
    """The parts of a multipart body by name, checked to be where the service looks for them."""
    boundary = request.headers["Content-Type"].removeprefix("multipart/form-data; boundary=").encode()
    pieces = request.content.split(b"--" + boundary)[1:-1]
    found = [re.search(rb'name="(\w+)".*?\r\n\r\n(.*)\r\n', piece, re.DOTALL) for piece in pieces]
    return {match[1]: match[2] for match in found if match}


def test_arrays_travel_beside_the_document_as_they_are() -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        assert parts(request) == {b"scene": b'{"output": {"precision": "exact"}, "a":  1}', b"arrays": b"\r\n--npz"}
        return exr()

    client(answer).render(b'{"a":  1}', arrays=b"\r\n--npz", precision="exact")


def test_arrays_by_name_become_a_file_that_numpy_reads() -> None:
    center, file, ids = np.ones((2, 3), np.float32, order="F"), np.array([1.0, 2.0]), np.arange(2, dtype=np.uint16)

    def answer(request: httpx.Request) -> httpx.Response:
        sent = np.load(io.BytesIO(parts(request)[b"arrays"]))
        assert set(sent) == {"center", "file", "odd name"}
        for name, array in (("center", center), ("file", file), ("odd name", ids)):
            assert sent[name].dtype == array.dtype
            assert np.array_equal(sent[name], array)
        return httpx.Response(200, content=b"{}", headers={"Content-Type": "application/json"})

    client(answer).canonical({}, arrays={"center": center, "file": file, "odd name": ids})


def test_objects_are_refused_before_they_are_sent() -> None:
    with pytest.raises(ValueError, match="Object arrays"):
        client(lambda _: exr()).render({}, arrays={"radius": np.array([{}])})


def test_arrays_are_sent_again_when_the_service_was_busy(naps: list[float]) -> None:
    bodies = []

    def answer(request: httpx.Request) -> httpx.Response:
        bodies.append(parts(request))
        return exr() if len(bodies) > 1 else httpx.Response(503, headers={"Retry-After": "1"})

    client(answer).render(b"{}", arrays=b"npz")
    assert naps == [1.0]
    assert bodies == [{b"scene": b"{}", b"arrays": b"npz"}] * 2


def test_a_kept_scene_is_named_by_its_id() -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        assert (request.method, request.url.path) == ("POST", "/v1/scenes")
        assert parts(request) == {b"scene": b"{}", b"arrays": b"npz"}
        headers = {"Content-Type": "application/json"}
        return httpx.Response(201, headers=headers, content=b'{"id": "a1", "quadrics": 1, "bytes": 150}')

    assert client(answer).keep({}, arrays=b"npz") == "a1"
