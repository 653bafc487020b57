"""Jobs over HTTP."""

import re
from typing import TYPE_CHECKING, Annotated, Any, Final
from urllib.parse import urlencode

import orjson
from fastapi import APIRouter, Header, Path, Query, Request, Response
from starlette.responses import StreamingResponse

from conicoid_service.bodies import receive
from conicoid_service.disconnects import while_connected
from conicoid_service.entity_tags import matches
from conicoid_service.errors import IdempotencyKeyError, NoJobsError
from conicoid_service.job_openapi import CANCEL_DOCS, EVENTS_DOCS, FRAME_DOCS, JOB_DOCS, JOBS_DOCS, SUBMIT_DOCS
from conicoid_service.jobs.documents import frame_document, job_document
from conicoid_service.jobs.events import END, job_events
from conicoid_service.jobs.records import Priority, State
from conicoid_service.responses import EXR_TYPE, BlobResponse, server_timing

if TYPE_CHECKING:  # the database's library takes as long to load as a short render
    from conicoid_service.jobs.jobs import Jobs

_KEY: Final = re.compile(r"[\x21-\x7e]{1,255}")
_MOST_JOBS: Final = 500
_MOST_FRAMES: Final = 10_000
_MOST_NUMBER: Final = 2**31 - 1

JobId = Annotated[str, Path(max_length=64)]

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


@router.post("", status_code=202, **SUBMIT_DOCS)
async def submit_job(request: Request, priority: Priority = "normal") -> Response:
    """Accept a document with `camera` or `cameras` as a job: it is on the disk when the answer comes.

    Of one key's jobs those of high `priority` come first. With an `Idempotency-Key` a request that is sent again,
    because its answer was lost, makes no second job.
    """
    return await submitted(request, {}, priority)


async def submitted(request: Request, headers: dict[str, str], priority: Priority = "normal") -> Response:
    """The answer to a request whose body is a job; `headers` are added to it."""
    jobs, key = jobs_of(request), request.headers.get("idempotency-key")
    if key is not None and not _KEY.fullmatch(key):
        raise IdempotencyKeyError("Idempotency-Key is not 1 to 255 visible ASCII characters; a UUID will do")
    body = await receive(request, request.app.state.settings)
    job, is_new, timings = await while_connected(request, jobs.submit(body, owner_of(request), key, priority))
    document = job_document(job)
    headers |= {"Location": document["href"], "Server-Timing": server_timing(timings)}
    return _json(document, 202 if is_new else 200, headers)


@router.get("", **JOBS_DOCS)
async def list_jobs(
    request: Request,
    limit: Annotated[int, Query(ge=1, le=_MOST_JOBS)] = 50,
    after: Annotated[str | None, Query(max_length=64)] = None,
    state: State | None = None,
) -> dict[str, Any]:
    """The jobs of this key, newest first; `next` is where the rest is."""
    found = await jobs_of(request).page(owner_of(request), limit + 1, after, state)
    following = None
    if found[limit:]:
        same = {"state": state} if state else {}
        following = f"/v1/jobs?{urlencode({'limit': limit, 'after': found[limit - 1].id} | same)}"
    return {"jobs": [job_document(job) for job in found[:limit]], "next": following}


@router.get("/{job_id}", **JOB_DOCS)
async def show_job(
    request: Request,
    job_id: JobId,
    first_frame: Annotated[int, Query(ge=0, le=_MOST_NUMBER)] = 0,
    frame_limit: Annotated[int, Query(ge=0, le=_MOST_FRAMES)] = 1000,
) -> dict[str, Any]:
    """A job, and `frame_limit` of its frames from `first_frame` on; `next` is where the rest is."""
    jobs = jobs_of(request)
    job = await jobs.job(job_id, owner_of(request))
    frames = await jobs.frames(job.id, first_frame, frame_limit)
    end = first_frame + len(frames)
    more = frame_limit and end < job.frames_total
    following = f"/v1/jobs/{job.id}?first_frame={end}&frame_limit={frame_limit}" if more else None
    return {**job_document(job), "frames": [frame_document(frame) for frame in frames], "next": following}


@router.get("/{job_id}/frames/{number}", response_class=Response, **FRAME_DOCS)
async def job_frame(request: Request, job_id: JobId, number: Annotated[int, Path(ge=0, le=_MOST_NUMBER)]) -> Response:
    """The image of a frame, once it is there."""
    jobs = jobs_of(request)
    job = await jobs.job(job_id, owner_of(request))
    known = request.headers.get("if-none-match")
    if (elsewhere := await jobs.image_elsewhere(job, number)) is not None:
        tag, link = elsewhere
        headers = {"ETag": tag, "Cache-Control": "no-store"}
        return (
            Response(None, 304, headers) if matches(known, tag) else Response(None, 307, {**headers, "Location": link})
        )
    tag, image = await while_connected(request, jobs.image(job, number))
    if matches(known, tag):
        image.blob.close()
        return Response(None, 304, {"ETag": tag})
    headers = {
        "ETag": tag,
        "Conicoid-Refined": str(image.refined),
        "Conicoid-Settled": str(image.settled),
        "Content-Disposition": f'attachment; filename="conicoid-{job.id}-{number:05}.exr"',
    }
    return BlobResponse(image.blob, headers, EXR_TYPE)


@router.get("/{job_id}/events", response_class=Response, **EVENTS_DOCS)
async def stream_job_events(
    request: Request, job_id: JobId, last_event_id: Annotated[str | None, Header(max_length=64)] = None
) -> Response:
    """The job's progress as server-sent events: `progress`, `frame` for each frame that ends, `end`.

    With the `Last-Event-ID` of a stream that was cut the next one goes on where it ended.
    """
    jobs = jobs_of(request)
    job = await jobs.job(job_id, owner_of(request))
    if last_event_id == END:
        return Response(status_code=204)
    seen = int(last_event_id) if last_event_id and last_event_id.isdecimal() and len(last_event_id) < 10 else 0
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(job_events(jobs, job.id, seen), headers=headers, media_type="text/event-stream")


@router.delete("/{job_id}", status_code=202, **CANCEL_DOCS)
async def cancel_job(request: Request, job_id: JobId) -> Response:
    """Cancel a job; frames that are done stay until it expires. Of a job that has ended nothing changes."""
    job, did = await jobs_of(request).cancel(job_id, owner_of(request))
    return _json(job_document(job), 202 if did else 200, {})


def owner_of(request: Request) -> str:
    """Whose request it is: the name of its API key, "" where there are none."""
    return str(getattr(request.state, "owner", ""))


def jobs_of(request: Request) -> "Jobs":
    """The job store.

    Raises:
        NoJobsError: this service has none.
    """
    jobs: Jobs | None = request.app.state.jobs
    if jobs is None:
        raise NoJobsError("this service keeps no jobs; start one with conicoid serve")
    return jobs


def _json(document: dict[str, Any], status: int, headers: dict[str, str]) -> Response:
    return Response(orjson.dumps(document), status, headers, "application/json")
