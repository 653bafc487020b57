"""Every malformed document is answered with a 4xx problem that names its place, by both routes that read one."""

import httpx
import pytest

from tests.malformed import CASES, Case
from tests.service.test_http import JSON, SCENE_ROUTES, assert_problem

pytestmark = pytest.mark.anyio


@pytest.mark.parametrize("path", SCENE_ROUTES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
async def test_a_malformed_document_is_a_problem_at_its_place(client: httpx.AsyncClient, path: str, case: Case) -> None:
    if case.arrays is None:
        response = await client.post(path, content=case.body, headers=JSON)
    else:
        response = await client.post(path, files={"scene": case.body, "arrays": case.npz()})
    problem = assert_problem(response, 400 if case.code in ("scene-json", "scene-npz") else 422, case.code)
    assert [(error["pointer"], error["code"]) for error in problem["errors"]] == [(case.pointer, case.code)]
