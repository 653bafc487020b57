"""The application in this process: its lifespan lasts as long as the transport, and its answers are the client's."""

import threading
from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager

import pytest
from fastapi import FastAPI, Request, Response

from conicoid_client import Client, ProblemError
from conicoid_client.local import LocalTransport


def application(events: list[str]) -> FastAPI:
    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        events.append("start")
        yield
        events.append("stop")

    app = FastAPI(lifespan=lifespan)

    @app.post("/v1/canonical")
    async def echo(request: Request) -> Response:
        return Response(await request.body(), media_type="application/json")

    @app.get("/v1/device")
    async def defect() -> Response:
        raise RuntimeError("a defect")

    return app


def test_lifespan_starts_with_the_transport_and_stops_with_the_client() -> None:
    events: list[str] = []
    with Client("http://conicoid", transport=LocalTransport(application(events))) as client:
        assert events == ["start"]
        assert client.canonical(b"{}") == b"{}"
    assert events == ["start", "stop"]


def test_a_body_of_any_size_arrives_whole() -> None:
    body = b" " * 5_000_000
    with Client("http://conicoid", transport=LocalTransport(application([]))) as client:
        assert client.canonical(body) == body


def test_a_defect_in_the_application_is_an_answer_not_a_crash() -> None:
    with (
        Client("http://conicoid", transport=LocalTransport(application([]))) as client,
        pytest.raises(ProblemError, match="500"),
    ):
        client.device()


def test_a_lifespan_that_fails_says_why_and_leaves_no_thread() -> None:
    def lifespan(_: FastAPI) -> AbstractAsyncContextManager[None]:
        raise OSError("no room")

    before = threading.active_count()
    with pytest.raises(OSError, match="no room"):
        LocalTransport(FastAPI(lifespan=lifespan))
    assert threading.active_count() == before
