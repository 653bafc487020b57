"""The OpenAPI document: bodies that the routes read and write by hand, described by hand.

The scene's schema is `conicoid.schema.json_schema()`, made from the table that the parser itself uses.
"""

from typing import Any, Final

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from conicoid_service.access.security_scheme import require_keys
from conicoid_service.problems import MEDIA_TYPE
from conicoid_service.responses import EXR_TYPE

EXR_CONTENT: Final = {EXR_TYPE: {"schema": {"type": "string", "format": "binary"}}}
SCENE: Final = {"$ref": "#/components/schemas/Scene"}
TIMING: Final = {"description": "milliseconds per stage", "schema": {"type": "string"}}
_PROBLEM: Final = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}


def _of_scene(*keys: str) -> dict[str, Any]:
    """Properties that are those of the scene document."""
    return {key: {"$ref": f"#/components/schemas/Scene/properties/{key}"} for key in keys}


BATCH: Final = {
    "type": "object",
    "description": "a scene document with a list of cameras in place of one",
    "required": ["conicoid", "cameras"],
    "additionalProperties": False,
    "properties": {
        **_of_scene("conicoid", "quadrics", "scene", "output"),
        "cameras": {"type": "array", "minItems": 1, "items": _of_scene("camera")["camera"]},
    },
    "oneOf": [
        {"required": ["quadrics"], "not": {"required": ["scene"]}},
        {"required": ["scene"], "not": {"required": ["quadrics"]}},
    ],
}
_QUADRICS: Final = {
    "type": "object",
    "description": "a scene document of which only the quadrics count",
    "required": ["conicoid", "quadrics"],
    "additionalProperties": False,
    "properties": _of_scene("conicoid", "quadrics", "camera", "output"),
}
_KEPT: Final = {
    "type": "object",
    "required": ["id", "quadrics", "bytes"],
    "properties": {
        "id": {"type": "string", "description": "what a document says as `scene`, in place of `quadrics`"},
        "quadrics": {"type": "integer", "description": "how many quadrics it has"},
        "bytes": {"type": "integer", "description": "what it takes of the room for kept scenes"},
    },
}


def body_docs(document: dict[str, Any]) -> dict[str, Any]:
    """The request's body: a document, alone or with arrays."""
    about_arrays = 'an .npz file of the arrays that the document\'s sets name as "@name"'
    parts = {
        "type": "object",
        "required": ["scene"],
        "additionalProperties": False,
        "properties": {
            "scene": document,
            "arrays": {"type": "string", "format": "binary", "description": about_arrays},
        },
    }
    types = {"scene": {"contentType": "application/json"}, "arrays": {"contentType": "application/octet-stream"}}
    content = {"application/json": {"schema": document}, "multipart/form-data": {"schema": parts, "encoding": types}}
    return {"requestBody": {"required": True, "content": content}}


IF_NONE_MATCH: Final = {
    "name": "If-None-Match",
    "in": "header",
    "required": False,
    "description": "entity tags of images that the client has already, or `*`",
    "schema": {"type": "string"},
}

_DESCRIPTIONS: Final = {
    400: "Not HTTP, JSON, multipart, gzip or .npz as it should be",
    401: "No API key of this service",
    404: "There is no such job, frame or kept scene",
    408: "The body arrives too slowly",
    413: "More bytes, quadrics or pixels than a limit allows",
    415: "Not `application/json` or `multipart/form-data`, or compressed in another way than gzip",
    422: "The scene document breaks a rule; `errors` names each place",
    429: "The queue is full, or the API key's requests are too many; try again after `Retry-After` seconds",
    500: "A defect, or the render process died with the request in it, twice",
    503: "No device, or starting, or shutting down",
    504: "The deadline passed",
    507: "The disk is full or not writable; try again after `Retry-After` seconds",
}

CHECKS: Final = {
    "type": "object",
    "description": "what `/readyz` checks: `ok`, or why not",
    "additionalProperties": {"type": "string"},
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
        "request_id": {"type": "string", "description": "names the request in the log; `X-Request-ID`"},
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
        "checks": CHECKS,
    },
}


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Responses of a route that are problem documents."""
    return {status: {"description": _DESCRIPTIONS[status], "content": _PROBLEM} for status in statuses}


RENDER_DOCS: Final[dict[str, Any]] = {
    "responses": {
        202: {"description": "With `Prefer: respond-async`: the job that renders it, as `POST /v1/jobs` answers"},
        200: {
            "description": "The image",
            "content": EXR_CONTENT,
            "headers": {
                "ETag": {"description": "strong: names these bytes", "schema": {"type": "string"}},
                "Server-Timing": TIMING,
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
        **problems(400, 404, 408, 413, 415, 422, 429, 500, 503, 504),
    },
    "openapi_extra": {**body_docs(SCENE), "parameters": [IF_NONE_MATCH]},
}
CANONICAL_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {
            "description": "The canonical document",
            "content": {"application/json": {"schema": {"oneOf": [SCENE, BATCH]}}},
            "headers": {"Server-Timing": TIMING},
        },
        **problems(400, 404, 408, 413, 415, 422, 429, 500, 503, 504),
    },
    "openapi_extra": body_docs({"oneOf": [SCENE, BATCH]}),
}
KEEP_DOCS: Final[dict[str, Any]] = {
    "responses": {
        201: {
            "description": "The scene is kept",
            "content": {"application/json": {"schema": _KEPT}},
            "headers": {"Location": {"schema": {"type": "string"}}, "Server-Timing": TIMING},
        },
        **problems(400, 408, 413, 415, 422, 429, 500, 503, 504),
    },
    "openapi_extra": body_docs(_QUADRICS),
}
DROP_DOCS: Final[dict[str, Any]] = {"responses": problems(404, 422)}
KEPT_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {"description": "The kept scene", "content": {"application/json": {"schema": _KEPT}}},
        **problems(404, 422),
    }
}
DEVICE_DOCS: Final[dict[str, Any]] = {"responses": problems(429, 500, 503)}
READY_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {
            "description": "A request that comes now would be answered",
            "content": {
                "application/json": {
                    "schema": {
                        "type": "object",
                        "required": ["status", "checks"],
                        "properties": {"status": {"const": "ready"}, "checks": CHECKS},
                    }
                }
            },
        },
        **problems(503),
    }
}
METRICS_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {"description": "Prometheus text format", "content": {"text/plain": {"schema": {"type": "string"}}}}
    }
}


def describe(app: FastAPI) -> dict[str, Any]:
    """The application's OpenAPI document, with the schemas of scenes and problems."""
    from conicoid.schema import json_schema  # loads NumPy, which no other answer of this process needs
    from conicoid_service.job_openapi import SCHEMAS

    document = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes, tags=app.openapi_tags
    )
    document.setdefault("components", {})["schemas"] = {"Problem": PROBLEM_SCHEMA, "Scene": json_schema(), **SCHEMAS}
    if app.state.settings.api_keys:
        require_keys(document, problems(401, 429))
    return document
