"""The scene document as JSON Schema, from the same table of fields that the parser checks by."""

from typing import Any

from conicoid.document.scene_fields import SCENE


def json_schema() -> dict[str, Any]:
    """The scene document as JSON Schema 2020-12.

    It refuses no valid document. What it cannot say is left to the parser: repeated keys, NaN, 640.0 for an integer,
    singular or asymmetric matrices, and comparisons between values.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Conicoid scene document",
        "description": "Quadrics, a camera and what to write. World units are the user's own, right-handed; angles "
        "are in degrees; every number is read as the nearest binary64.",
    } | SCENE.schema()
