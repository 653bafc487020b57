"""Whatever the document, the service answers with an image or a problem, and goes on. `make fuzz` tries thousands."""

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.cl.broken_documents import documents_with_junk, mutated_documents
from tests.service.test_http import JSON, assert_problem

pytestmark = pytest.mark.anyio


@given(body=st.binary(max_size=200) | mutated_documents() | documents_with_junk())
async def test_any_document_is_answered_with_an_image_or_a_problem(client: httpx.AsyncClient, body: bytes) -> None:
    response = await client.post("/v1/render", content=body, headers=JSON)
    if response.status_code != 200:
        assert response.status_code in (400, 404, 413, 422)
        assert_problem(response, response.status_code, response.json()["code"])
