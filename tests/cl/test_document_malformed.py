"""Every malformed document is refused at its place with its code, by the parser and, where it can tell, the schema."""

import json

import jsonschema
import pytest

from conicoid.errors import SceneError
from conicoid.schema import json_schema
from tests.malformed import CASES, Case

SCHEMA = jsonschema.Draft202012Validator(json_schema())


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_a_malformed_document_has_one_problem_at_its_place(case: Case) -> None:
    with pytest.raises(SceneError) as caught:
        case.parse()
    assert [(problem.pointer, problem.code) for problem in caught.value.problems] == [(case.pointer, case.code)]


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_a_message_is_one_printable_line_with_a_remedy(case: Case) -> None:
    with pytest.raises(SceneError) as caught:
        case.parse()
    (problem,) = caught.value.problems
    assert problem.message.isprintable()
    assert problem.message.isascii()
    assert len(problem.message) < 300
    assert ";" in problem.message


@pytest.mark.parametrize(
    "case", [case for case in CASES if case.schema is not None], ids=[c.name for c in CASES if c.schema is not None]
)
def test_the_schema_refuses_what_a_schema_can_express(case: Case) -> None:
    assert SCHEMA.is_valid(json.loads(case.body)) is not case.schema


def test_names_of_cases_are_unique() -> None:
    assert len({case.name for case in CASES}) == len(CASES) >= 130
