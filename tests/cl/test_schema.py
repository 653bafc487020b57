"""The published schema, the parser and docs/scene.md say the same."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.canonical import canonical_bytes
from conicoid.document import parse
from conicoid.document.scene_fields import BATCH
from conicoid.errors import SceneError
from conicoid.schema import json_schema
from tests.cl.documents import Json, documents
from tests.malformed import CASES

SCHEMA = jsonschema.Draft202012Validator(json_schema())
DOCS = (Path(__file__).parents[2] / "docs" / "scene.md").read_text()
HEADINGS = {"Document": [], "Quadrics": ["quadrics", "items"], "Camera": ["camera"], "Output": ["output"]}


def test_the_schema_is_json_schema_2020_12() -> None:
    jsonschema.Draft202012Validator.check_schema(json_schema())
    assert json.loads(json.dumps(json_schema())) == json_schema()


@given(documents)
def test_valid_documents_and_their_canonical_forms_satisfy_the_schema(document: Json) -> None:
    SCHEMA.validate(document)
    SCHEMA.validate(json.loads(canonical_bytes(parse(json.dumps(document).encode()).resolve())))


def objects(schema: Any) -> Iterator[Json]:
    """Every schema of an object with properties, at any depth."""
    if isinstance(schema, dict):
        if "properties" in schema and "additionalProperties" in schema:
            yield schema
        for inner in schema.values():
            yield from objects(inner)
    elif isinstance(schema, list):
        for inner in schema:
            yield from objects(inner)


def test_every_key_is_described_and_no_object_takes_others() -> None:
    found = list(objects(json_schema()))
    assert len(found) == 1 + 2 * 14 + 2 * 2 + 1
    for schema in found:
        assert schema["additionalProperties"] is False
        assert all(schema["properties"][key]["description"] for key in schema["properties"])


def test_every_default_is_valid_where_it_stands() -> None:
    for schema in objects(json_schema()):
        for key, value in schema["properties"].items():
            if "default" in value:
                jsonschema.Draft202012Validator(value).validate(value["default"])
                assert key in DOCS


def section(heading: str) -> str:
    found = re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", DOCS, re.DOTALL | re.MULTILINE)
    assert found
    return found[1]


def documented_keys(text: str) -> set[str]:
    """The keys in the first column of tables whose head says `key`."""
    keys: set[str] = set()
    for table in re.findall(r"^\| key \|.*\n\|[-|]+\|\n((?:\|.*\n)+)", text, re.MULTILINE):
        for row in table.splitlines():
            keys |= set(re.findall(r"`(\w+)`", row.split("|")[1]))
    return keys


def schema_keys(schema: Json) -> set[str]:
    variants = schema.get("oneOf", [schema]) if "properties" not in schema else [schema]
    return {key for variant in variants for key in variant["properties"]}


@pytest.mark.parametrize("heading", HEADINGS)
def test_the_docs_have_every_key_and_no_other(heading: str) -> None:
    schema = json_schema()
    for step in HEADINGS[heading]:
        schema = schema[step] if step == "items" else schema["properties"][step]
    keys = schema_keys(schema)
    if heading == "Camera":
        keys |= {"eye", "target", "up"}
    if heading == "Document":
        keys |= BATCH.fields.keys()
    assert documented_keys(section(heading)) == keys


def test_the_docs_have_every_shape_with_its_parameters() -> None:
    rows = re.findall(r"^\| `(\w+)` \| .* \| (.*) \|$", section("Quadrics").split("| key |")[0], re.MULTILINE)
    parameters = {"radius", "radii", "matrix", "coefficients"}
    variants = json_schema()["properties"]["quadrics"]["items"]["oneOf"]
    expected = {v["properties"]["shape"]["const"]: parameters & v["properties"].keys() for v in variants}
    assert {shape: set(re.findall(r"`(\w+)`", given)) for shape, given in rows} == expected


def test_the_docs_have_every_word() -> None:
    for schema in objects(json_schema()):
        for value in schema["properties"].values():
            words = value.get("enum", []) + value.get("items", {}).get("enum", [])
            assert all(f"`{word}`" in DOCS for word in words)


def test_the_docs_have_every_code_and_no_other() -> None:
    documented = set(re.findall(r"^\| `(scene-[a-z-]+)` \|", section("Errors"), re.MULTILINE))
    source = Path(__file__).parents[2] / "cl" / "conicoid" / "document"
    used = {code for file in source.glob("*.py") for code in re.findall(r'"(scene-[a-z-]+)"', file.read_text())}
    assert documented == used == {case.code for case in CASES}


def test_the_examples_of_the_docs_are_valid() -> None:
    examples = re.findall(r"^```json\n(.*?)^```", DOCS, re.DOTALL | re.MULTILINE)
    assert examples
    for example in examples:
        parse(example.encode()).resolve()
        SCHEMA.validate(json.loads(example))


@given(documents, st.data())
def test_what_the_schema_refuses_the_parser_refuses(document: Json, data: st.DataObject) -> None:
    """One value replaced: if the document is still valid to the parser, it is to the schema."""
    target = data.draw(st.sampled_from([document["camera"], document, *document["quadrics"]]))
    key = data.draw(st.sampled_from(sorted(target)))
    target[key] = data.draw(
        st.sampled_from([None, True, "x", 0, 1, -1, 0.5, [], [0, 0, 0], [1] * 4, [[1] * 4] * 4, {}])
    )
    try:
        parse(json.dumps(document).encode())
    except SceneError:
        return
    SCHEMA.validate(document)
