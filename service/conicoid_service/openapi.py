"""The OpenAPI document: bodies that the routes read and write by hand, described by hand.

The scene's schema is `conicoid.schema.json_schema()`, made from the table that the parser itself uses.
"""

from typing import Any, Final

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from conicoid.schema import json_schema
from conicoid_service.problems import MEDIA_TYPE
from conicoid_service.responses import EXR_TYPE

_SCENE: Final = {"$ref": "#/components/schemas/Scene"}
_TIMING: Final = {"description": "milliseconds per stage", "schema": {"type": "string"}}
_PROBLEM: Final = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
_MULTIPART: Final = {
    "schema": {
        "type": "object",
        "required": ["scene"],
        "additionalProperties": False,
        "properties": {
            "scene": _SCENE,
            "arrays": {
                "type": "string",
                "format": "binary",
                "description": 'an .npz file of the arrays that the scene\'s sets name as "@name"',
            },
        },
    },
    "encoding": {"scene": {"contentType": "application/json"}, "arrays": {"contentType": "application/octet-stream"}},
}
_BODY: Final = {
    "requestBody": {
        "required": True,
        "content": {"application/json": {"schema": _SCENE}, "multipart/form-data": _MULTIPART},
    }
}
_IF_NONE_MATCH: Final = {
    "name": "If-None-Match",
    "in": "header",
    "required": False,
    "description": "entity tags of images that the client has already, or `*`",
    "schema": {"type": "string"},
}

_DESCRIPTIONS: Final = {
    400: "Not HTTP, JSON, multipart or .npz as it should be",
    413: "More bytes, quadrics or pixels than a limit allows",
    415: "Not `application/json` or `multipart/form-data`, or compressed",
    422: "The scene document breaks a rule; `errors` names each place",
    429: "The queue is full; try again after `Retry-After` seconds",
    500: "A defect, or the render process died with the request in it, twice",
    503: "No device, or starting, or shutting down",
    504: "The deadline passed",
}

PROBLEM_SCHEMA: Final[dict[str, Any]] = {
    "type": "object",
    "description": "RFC 9457 problem details",
    "required": ["type", "title", "status", "detail", "code", "errors"],
    "properties": {
        "type": {"type": "string", "format": "uri"},
        "title": {"type": "string"},
        "status": {"type": "integer"},
        "detail": {"type": "string", "description": "one readable paragraph: place, value, rule, remedy"},
        "code": {"type": "string", "description": "stable; docs/errors.md explains each"},
        "errors": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["pointer", "message", "code"],
                "properties": {
                    "pointer": {"type": "string", "examples": ["quadrics[3].radius"]},
                    "message": {"type": "string"},
                    "code": {"type": "string"},
                },
            },
        },
        "limit": {"type": "integer", "description": "the limit that was passed"},
        "asked": {"type": "integer", "description": "what the request asks"},
    },
}


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Responses of a route that are problem documents."""
    return {status: {"description": _DESCRIPTIONS[status], "content": _PROBLEM} for status in statuses}


RENDER_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {
            "description": "The image",
            "content": {EXR_TYPE: {"schema": {"type": "string", "format": "binary"}}},
            "headers": {
                "ETag": {"description": "strong: names these bytes", "schema": {"type": "string"}},
                "Server-Timing": _TIMING,
                "Conicoid-Refined": {
                    "description": "pixels rounded in double-double",
                    "schema": {"type": "integer"},
                },
                "Conicoid-Settled": {
                    "description": "pixels settled in exact arithmetic on the host",
                    "schema": {"type": "integer"},
                },
                "Content-Disposition": {"schema": {"type": "string"}},
            },
        },
        304: {"description": "The client has this image already"},
        **problems(400, 413, 415, 422, 429, 500, 503, 504),
    },
    "openapi_extra": {**_BODY, "parameters": [_IF_NONE_MATCH]},
}
CANONICAL_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {
            "description": "The canonical document",
            "content": {"application/json": {"schema": _SCENE}},
            "headers": {"Server-Timing": _TIMING},
        },
        **problems(400, 413, 415, 422, 429, 500, 503, 504),
    },
    "openapi_extra": _BODY,
}
DEVICE_DOCS: Final[dict[str, Any]] = {"responses": problems(429, 500, 503)}
READY_DOCS: Final[dict[str, Any]] = {"responses": problems(503)}


def describe(app: FastAPI) -> dict[str, Any]:
    """The application's OpenAPI document, with the schemas of scenes and problems."""
    document = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes, tags=app.openapi_tags
    )
    document.setdefault("components", {})["schemas"] = {"Problem": PROBLEM_SCHEMA, "Scene": json_schema()}
    return document
