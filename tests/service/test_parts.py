"""A frame of many cameras, and a band of a frame, are asked for in the query of a render."""

from collections.abc import AsyncIterator
from typing import Any

import httpx
import pytest

from conicoid_service.parts import Part
from conicoid_service.settings import Settings
from tests.service.conftest import FAKE, SCENE, serving
from tests.service.test_http import assert_problem

pytestmark = pytest.mark.anyio

CAMERAS: list[dict[str, Any]] = [SCENE["camera"] | {"fov_y": fov, "crop": [0, 0, 40, 20]} for fov in (30, 40, 50)]
BATCH = {key: value for key, value in SCENE.items() if key != "camera"} | {"cameras": CAMERAS}
ONE = SCENE | {"camera": CAMERAS[1]}


@pytest.fixture
async def caching(search_path: None) -> AsyncIterator[httpx.AsyncClient]:  # noqa: ARG001
    async with serving(Settings(), FAKE) as client:
        yield client


async def tag(client: httpx.AsyncClient, document: dict[str, Any], **query: Any) -> str:
    response = await client.post("/v1/render", json=document, params=query)
    assert response.status_code == 200, response.text
    return str(response.headers["etag"])


async def test_a_frame_is_the_image_of_its_camera(caching: httpx.AsyncClient) -> None:
    alone = await tag(caching, ONE)
    assert await tag(caching, BATCH, frame=1) == alone
    assert await tag(caching, ONE, frame=0) == alone


async def test_every_part_of_one_body_is_another_image_also_when_the_body_is_known(caching: httpx.AsyncClient) -> None:
    parts: list[dict[str, Any]] = [{"frame": 0}, {"frame": 1}, {"frame": 1, "band": "0/2"}, {"frame": 1, "band": "1/2"}]
    first = [await tag(caching, BATCH, **part) for part in parts]
    assert len({*first}) == len(parts)
    assert [await tag(caching, BATCH, **part) for part in parts] == first
    assert await tag(caching, ONE, band="1/2") == first[3]


async def test_a_band_is_its_rows_of_the_crop_for_joining(caching: httpx.AsyncClient) -> None:
    rows = SCENE | {"camera": CAMERAS[0] | {"crop": [0, 10, 40, 20]}, "output": {"channels": ["Z", "A"]}}
    tight = SCENE | {"camera": CAMERAS[0], "output": {"channels": ["Z"], "data_window": "tight", "compression": "piz"}}
    assert await tag(caching, tight, band="1/2") == await tag(caching, rows)


@pytest.mark.parametrize(
    ("document", "query", "message"),
    [
        (BATCH, {"frame": 3}, "frame: 3 is not a frame of this scene; give one of 0 to 2"),
        (ONE, {"frame": 1}, "frame: 1 is not a frame of this scene; give one of 0 to 0"),
        (ONE, {"band": "2/2"}, "band: 2/2 is not one of at most 20 bands"),
        (ONE, {"band": "0/0"}, "band: 0/0 is not one of at most 20 bands"),
        (ONE, {"band": "20/21"}, "band: 20/21 is not one of at most 20 bands"),
        (BATCH, {"frame": -1}, "query.frame: Input should be greater than or equal to 0"),
        (ONE, {"band": "1"}, "query.band: String should match pattern"),
    ],
)
async def test_a_part_that_is_not_there_is_a_problem(
    client: httpx.AsyncClient, document: dict[str, Any], query: dict[str, Any], message: str
) -> None:
    problem = assert_problem(await client.post("/v1/render", json=document, params=query), 422, "parameter")
    assert problem["detail"].startswith(message)


async def test_many_cameras_without_a_frame_are_a_problem_that_says_how_to_name_one(client: httpx.AsyncClient) -> None:
    problem = assert_problem(await client.post("/v1/render", json=BATCH), 422, "scene-unsupported")
    assert "name one of the frames" in problem["detail"]


async def test_limits_hold_for_what_is_rendered(search_path: None) -> None:  # noqa: ARG001
    async with serving(Settings(pixel_limit=400), FAKE) as client:
        assert_problem(await client.post("/v1/render?frame=0", json=BATCH), 413, "limit")
        assert (await client.post("/v1/render?frame=0&band=0/2", json=BATCH)).status_code == 200


def test_a_query_names_a_part() -> None:
    assert Part.of(None, None) == Part()
    assert Part.of(3, "0/12") == Part(3, (0, 12))
