"""The jobs' part of the OpenAPI document."""

from typing import Any, Final

from conicoid_service.jobs.records import PRIORITIES, STATES
from conicoid_service.openapi import BATCH, EXR_CONTENT, IF_NONE_MATCH, SCENE, TIMING, body_docs, problems

_TIME: Final = {"type": ["string", "null"], "format": "date-time"}
_COUNTS: Final = {
    "frames_total": {"type": "integer", "description": "frames of the job"},
    "frames_done": {"type": "integer", "description": "frames that have an image"},
    "frames_failed": {"type": "integer", "description": "frames that ended without one"},
}
_STATE: Final = {"type": "string", "enum": list(STATES)}


def _object(properties: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"type": "object", "required": list(properties), "properties": properties, **more}


_FRAME: Final = _object(
    {
        "frame": {"type": "integer", "description": "number in the job, from 0"},
        "state": _STATE,
        "href": {"type": "string", "description": "where its image is, or will be"},
        "etag": {"type": ["string", "null"], "description": "entity tag of its image"},
        "bytes": {"type": ["integer", "null"], "description": "of its image"},
        "error": {
            "oneOf": [{"type": "null"}, _object({"code": {"type": "string"}, "detail": {"type": "string"}})],
            "description": "why it failed",
        },
    }
)
_JOB: Final[dict[str, Any]] = {
    "id": {"type": "string"},
    "state": _STATE,
    "priority": {"type": "string", "enum": list(PRIORITIES)},
    "created": {"type": "string", "format": "date-time"},
    "started": _TIME,
    "finished": _TIME,
    "expires": {**_TIME, "description": "when job and images are given up; null while it has not ended"},
    **_COUNTS,
    "href": {"type": "string"},
    "events": {"type": "string", "description": "where its progress is told"},
}
_NEXT: Final = {"type": ["string", "null"], "description": "where the rest is"}
SCHEMAS: Final[dict[str, Any]] = {
    "Job": _object(_JOB),
    "Frame": _FRAME,
    "JobWithFrames": _object(
        {**_JOB, "frames": {"type": "array", "items": {"$ref": "#/components/schemas/Frame"}}, "next": _NEXT}
    ),
    "Jobs": _object({"jobs": {"type": "array", "items": {"$ref": "#/components/schemas/Job"}}, "next": _NEXT}),
}

_STORAGE: Final = (413, 415, 422, 429, 500, 503, 504, 507)


def _answer(description: str, schema: str, **headers: Any) -> dict[str, Any]:
    content = {"application/json": {"schema": {"$ref": f"#/components/schemas/{schema}"}}}
    return {"description": description, "content": content} | ({"headers": headers} if headers else {})


def _link(operation: str, **parameters: str) -> dict[str, Any]:
    return {"operationId": operation, "parameters": {"job_id": "$response.body#/id", **parameters}}


_LINKS: Final = {
    "job": _link("show_job"),
    "frame": _link("job_frame", number="0"),
    "events": _link("stream_job_events"),
    "cancel": _link("cancel_job"),
}
_LOCATION: Final = {"description": "of the job", "schema": {"type": "string"}}
ACCEPTED: Final = {
    **_answer("The job is accepted", "Job", **{"Location": _LOCATION, "Server-Timing": TIMING}),
    "links": _LINKS,
}
SUBMIT_DOCS: Final[dict[str, Any]] = {
    "responses": {
        202: ACCEPTED,
        200: _answer("The job that the same request made before", "Job", Location=_LOCATION),
        **problems(400, 404, 408, *_STORAGE),
    },
    "openapi_extra": {
        **body_docs({"oneOf": [SCENE, BATCH]}),
        "parameters": [
            {
                "name": "Idempotency-Key",
                "in": "header",
                "required": False,
                "description": "a name for this request: the same one, sent again, makes no second job",
                "schema": {"type": "string", "minLength": 1, "maxLength": 255, "pattern": "^[!-~]+$"},
            }
        ],
    },
}
JOBS_DOCS: Final[dict[str, Any]] = {"responses": {200: _answer("Some jobs", "Jobs"), **problems(422, 500, 503, 507)}}
JOB_DOCS: Final[dict[str, Any]] = {
    "responses": {200: _answer("The job", "JobWithFrames"), **problems(404, 422, 500, 503, 507)}
}
FRAME_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {
            "description": "The image",
            "content": EXR_CONTENT,
            "headers": {"ETag": {"description": "strong: names these bytes", "schema": {"type": "string"}}},
        },
        304: {"description": "The client has this image already"},
        307: {
            "description": "The image is in the object store, where `Location` lets anybody read it for a while",
            "headers": {"Location": {"description": "a signed URL", "schema": {"type": "string"}}},
        },
        **problems(404, 422, 429, 500, 503, 504, 507),
    },
    "openapi_extra": {"parameters": [IF_NONE_MATCH]},
}
EVENTS_DOCS: Final[dict[str, Any]] = {
    "responses": {
        200: {
            "description": "`progress`: the job; `frame`: a frame that ended, its id says how many had; `end`: the job",
            "content": {"text/event-stream": {}},
        },
        204: {"description": "The client has seen the end"},
        **problems(404, 422, 500, 503, 507),
    }
}
CANCEL_DOCS: Final[dict[str, Any]] = {
    "responses": {
        202: _answer("The job, which is cancelled", "Job"),
        200: _answer("The job, which had ended already", "Job"),
        **problems(404, 422, 500, 503, 507),
    }
}
