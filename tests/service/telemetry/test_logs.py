"""One line for each request, whatever happens to it; every line says which request or job it is about."""

import json
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from conicoid_service.settings import Settings
from conicoid_service.telemetry import context
from conicoid_service.telemetry.logs import configure
from tests.service.conftest import FAKE, SCENE, named, serving

pytestmark = pytest.mark.anyio

NAME = "conicoid_service.test"


@pytest.fixture
def root_logger() -> Iterator[None]:
    """Undoes what `configure` does."""
    loggers = [logging.getLogger(name) for name in ("", "conicoid_service", "uvicorn")]
    before = [(one.level, one.handlers[:]) for one in loggers]
    yield
    for one, (level, handlers) in zip(loggers, before, strict=True):
        one.level, one.handlers[:] = level, handlers


def lines(caplog: pytest.LogCaptureFixture) -> list[dict[str, Any]]:
    return [vars(one) for one in caplog.records if one.name == "conicoid_service.telemetry.requests"]


async def test_a_render_has_one_line_with_its_stages(
    client: httpx.AsyncClient, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "conicoid_service")
    image = await client.post("/v1/render", json=SCENE)
    (line,) = lines(caplog)
    assert (line["method"], line["route"], line["status"]) == ("POST", "/v1/render", 200)
    assert line["bytes_out"] == len(image.content)
    assert line["image"] == "rendered"
    assert line["stages_ms"].keys() == {"queue", "parse", "setup", "cast", "encode"}
    assert sum(line["stages_ms"].values()) > 0


async def test_a_refusal_has_one_line_with_its_code_and_nothing_of_the_client_s(
    client: httpx.AsyncClient, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "conicoid_service")
    await client.post("/v1/render?key=sekret", json=named("sekret") | {"sekret": 1}, headers={"Cookie": "sekret"})
    await client.get("/sekret")
    assert [line["code"] for line in lines(caplog)] == ["scene-unknown-key", "not-found"]
    assert "sekret" not in repr(lines(caplog))


async def test_probes_that_succeed_are_not_logged(client: httpx.AsyncClient, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "conicoid_service")
    await client.get("/livez")
    await client.get("/metrics")
    assert not lines(caplog)


@pytest.mark.parametrize("given", ["a", "0aZ._-", "x" * 128])
async def test_a_request_id_is_taken_over_and_names_problems(client: httpx.AsyncClient, given: str) -> None:
    response = await client.get("/nothing", headers={"X-Request-ID": given})
    assert response.headers["x-request-id"] == response.json()["request_id"] == given


@pytest.mark.parametrize("given", ["", " ", "x" * 129, "a b", "a\tb", "ü", '"'])
async def test_an_unusable_request_id_is_replaced_by_one_like_no_other(client: httpx.AsyncClient, given: str) -> None:
    made = {
        (await client.get("/livez", headers=[(b"x-request-id", given.encode())])).headers["x-request-id"] for _ in "ab"
    }
    assert len(made) == 2
    assert given not in made


@pytest.mark.usefixtures("search_path")
async def test_lines_of_a_child_say_which_request_they_are_about(
    capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    async with serving(Settings(data_dir=tmp_path), FAKE) as client:
        await client.post("/v1/render", json=named("defect"), headers={"X-Request-ID": "the-one"})
    assert "a defect request_id=the-one" in capfd.readouterr().err


@pytest.mark.usefixtures("root_logger")
def test_json_lines_have_ids_extras_and_tracebacks_and_stay_lines(capsys: pytest.CaptureFixture[str]) -> None:
    configure("json")
    context.adopt({"request_id": "r"})
    logger = logging.getLogger(NAME)
    logger.info("frame\ndone", extra={"job_id": "j", "frame": 3})
    logger.error("oh", exc_info=ZeroDivisionError())
    context.adopt({})
    first, second = (json.loads(line) for line in capsys.readouterr().err.splitlines())
    assert first.pop("time").startswith("2")
    assert first == {
        "level": "INFO", "logger": NAME, "message": "frame\ndone", "request_id": "r", "job_id": "j", "frame": 3,
    }  # fmt: skip
    assert "ZeroDivisionError" in second["traceback"]


@pytest.mark.usefixtures("root_logger")
def test_text_lines_have_the_same_fields_and_no_client_can_begin_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    configure("text")
    logging.getLogger(NAME).info("frame\ndone\x1b[2J", extra={"job_id": "j", "why": "a\nb"})
    written = capsys.readouterr().err
    assert written.endswith(f'INFO {NAME}: frame\\ndone\\x1b[2J job_id=j why="a\\nb"\n')
    assert len(written.splitlines()) == 1
