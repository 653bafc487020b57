"""What the service does for scenes: render, canonical form, keep; and what it does it with."""

from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import version
from typing import Annotated, Any, Final

from fastapi import APIRouter, Query, Request, Response

from conicoid import __version__
from conicoid_service.bodies import Body, receive
from conicoid_service.disconnects import while_connected
from conicoid_service.entity_tags import entity_tag, matches
from conicoid_service.gallery import Gallery, Shown
from conicoid_service.job_routes import owner_of, submitted
from conicoid_service.openapi import CANONICAL_DOCS, DEVICE_DOCS, DROP_DOCS, KEEP_DOCS, KEPT_DOCS, RENDER_DOCS
from conicoid_service.pipeline import Pipeline, Timings
from conicoid_service.responses import EXR_TYPE, BlobResponse, server_timing
from conicoid_service.settings import Settings
from conicoid_service.telemetry import context

LIBRARIES = ("OpenEXR", "pyopencl", "numpy", "fastapi", "uvicorn")

# Stages that an answer did not need.
_UNREAD: Final[Timings] = {"queue": 0.0, "parse": 0.0, "setup": 0.0}
_UNDRAWN: Final[Timings] = {"cast": 0.0, "encode": 0.0}

router = APIRouter(prefix="/v1", tags=["scenes"])


@router.post("/render", response_class=Response, **RENDER_DOCS)
async def render(
    request: Request,
    frame: Annotated[
        int | None, Query(ge=0, le=2**31 - 1, description="which of the document's cameras, from 0")
    ] = None,
    band: Annotated[str | None, Query(pattern=r"^[0-9]{1,9}/[0-9]{1,9}$", description="I/N, band I of N")] = None,
) -> Response:
    """Render a scene document with one camera to an OpenEXR image.

    With `frame` the document may have many `cameras`, of which it says one. With `band` the image is that part of the
    frame's rows, which `conicoid join` joins to the frame.

    The strong `ETag` names the image's bytes: a request that has it in `If-None-Match` is answered 304, unrendered.
    An image that was rendered lately is sent again, unrendered too.
    `Server-Timing` gives milliseconds: queue, parse (body to arrays), setup (per quadric), cast (per pixel), encode;
    0 for stages that this answer did not need.
    Of the pixels that binary64 could not certify, `Conicoid-Refined` counts those that double-double rounded,
    `Conicoid-Settled` those that exact arithmetic settled on the host.
    """
    if _wants_job(request):
        return await submitted(request, {"Preference-Applied": "respond-async"})
    settings, pipeline = _parts(request)
    body = await receive(request, settings)
    asked = _Asked(request.headers.get("if-none-match"), owner_of(request), frame, band)
    return await while_connected(request, _render(pipeline, request.app.state.gallery, body, asked))


@dataclass(frozen=True)
class _Asked:
    """What a request says beside its body."""

    if_none_match: str | None
    owner: str
    frame: int | None
    band: str | None


async def _render(pipeline: Pipeline, gallery: Gallery, body: Body, asked: _Asked) -> Response:
    request = f"{body.digest} {asked.frame} {asked.band}"
    known = gallery.images.tag_of(request)
    if known and (response := await _at_hand(gallery, known, asked, _UNREAD)):
        body.blob.close()
        return response
    read = await pipeline.read(body, asked.frame, asked.band)
    with read.view, read.quadrics:
        tag = entity_tag(read.scene_hash, (await pipeline.device())["device"])
        if not read.kept:  # else the body says too little: what it names may be dropped
            gallery.images.note(request, tag)
        if response := await _at_hand(gallery, tag, asked, read.timings):
            return response
        shown = await gallery.show(tag, read, owner=asked.owner)
    return _image(shown, tag, read.timings)


async def _at_hand(gallery: Gallery, tag: str, asked: _Asked, timings: Timings) -> Response | None:
    """The answer without rendering: 304 if the client has the image, the image if the service has it still."""
    if matches(asked.if_none_match, tag):
        context.notes().image = "304"
        return Response(None, 304, {"ETag": tag, "Server-Timing": server_timing(timings)})
    shown = await gallery.at_hand(tag)
    return None if shown is None else _image(shown, tag, timings)


def _image(shown: Shown, tag: str, timings: Timings) -> Response:
    image = shown.image
    context.notes().image = shown.source
    headers = {
        "ETag": tag,
        "Server-Timing": server_timing(timings, shown.timings or _UNDRAWN),
        "Conicoid-Refined": str(image.refined),
        "Conicoid-Settled": str(image.settled),
        "Content-Disposition": f'attachment; filename="conicoid-{image.scene_hash[:12]}.exr"',
    }
    return BlobResponse(image.blob, headers, EXR_TYPE)


def _wants_job(request: Request) -> bool:
    """Whether `Prefer` (RFC 7240) asks for an answer before the image is there."""
    preferences = ",".join(request.headers.getlist("prefer")).split(",")
    return "respond-async" in {one.partition(";")[0].strip().lower() for one in preferences}


@router.post("/canonical", response_class=Response, **CANONICAL_DOCS)
async def canonical(request: Request) -> Response:
    """The document's canonical form: everything resolved, every default filled in; it renders to the same bytes."""
    settings, pipeline = _parts(request)
    body = await receive(request, settings)
    text, timings = await while_connected(request, pipeline.canonical(body))
    return Response(text, headers={"Server-Timing": server_timing(timings)}, media_type="application/json")


@router.post("/scenes", status_code=201, **KEEP_DOCS)
async def keep(request: Request, response: Response) -> dict[str, Any]:
    """Keep the quadrics of a document, to render them from many cameras without sending them again.

    A render says `"scene": id` in place of `quadrics`. The id is made of the quadrics, so the same have the same id
    always and everywhere. What was not used for longest is dropped when room is needed.
    """
    settings, pipeline = _parts(request)
    body = await receive(request, settings)
    kept, timings = await while_connected(request, pipeline.keep(body))
    response.headers.update({"Location": f"/v1/scenes/{kept.id}", "Server-Timing": server_timing(timings)})
    return asdict(kept)


@router.get("/scenes/{scene_id}", **KEPT_DOCS)
async def kept_scene(request: Request, scene_id: str) -> dict[str, Any]:
    """A kept scene: its id, how many quadrics it has, the bytes that it takes."""
    return asdict(await _parts(request)[1].kept.about(scene_id))


@router.delete("/scenes/{scene_id}", status_code=204, **DROP_DOCS)
async def drop(request: Request, scene_id: str) -> None:
    """Give a kept scene up; renders of it that have begun go on."""
    await _parts(request)[1].kept.drop(scene_id)


@router.get("/device", **DEVICE_DOCS)
async def device(request: Request) -> dict[str, Any]:
    """What renders here: OpenCL platform and device, versions, limits, and what each precision means."""
    settings, pipeline = _parts(request)
    hello = await pipeline.device()
    opencl = hello["device"]
    return {
        "version": __version__,
        "platform": opencl["platform"],
        "platform_version": opencl["version"],
        "device": opencl["name"],
        "compute_units": opencl["compute_units"],
        "global_memory": opencl["global_memory"],
        "threads": hello["threads"],
        "libraries": _libraries(),
        "precision": {
            "exact": "every hit and id decided exactly, every depth correctly rounded; see docs/exactness.md",
            "float64": "evaluated in binary64 after an accurate set-up",
            "float32": "evaluated in binary32 after an accurate set-up",
        },
        "limits": {
            "body_bytes": settings.body_limit,
            "quadrics": settings.quadric_limit,
            "pixels": settings.pixel_limit,
            "kept_bytes": settings.kept_limit,
            "queue": settings.queue_length,
            "deadline_s": settings.deadline_s,
        },
    }


@cache
def _libraries() -> dict[str, str]:
    """Names and versions, which take milliseconds to look up."""
    return {name: version(name) for name in LIBRARIES}


def _parts(request: Request) -> tuple[Settings, Pipeline]:
    return request.app.state.settings, request.app.state.pipeline
