"""The document process: hostile bytes in, resolved scenes or canonical documents out. No OpenCL here."""

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Final

from numpy.typing import NDArray

from conicoid.canonical import canonical_batch_bytes, canonical_bytes, quadrics_hash, view_hash
from conicoid.document import Batch, Document, parse_batch, parse_quadrics, read_npz
from conicoid.errors import LimitError, QuadricsFileError
from conicoid.quadrics_file import quadrics_bytes, quadrics_from
from conicoid.scene import Camera, Output, Quadrics, Scene
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.errors import MultipartError
from conicoid_service.multipart import REMEDY, parts_of
from conicoid_service.parts import Part, read_document, view_of
from conicoid_service.views import view_line
from conicoid_service.worker import Handler, Reply, serve

_LONGEST_ID: Final = 100  # of the ids that a body may name; no id is as long


def start(_: Message) -> tuple[Handler, Message]:
    """Nothing to prepare: importing was the work."""
    return handle, {}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    """Answer with what `message["do"]` names, for the body in the first blob.

    `read`: `scene_hash` and `quadrics_hash`, with the view's line, and the quadrics; of which `frame` and `band` is as
    in `parts.Part.of`.
    `batch`: the number of `frames` and `quadrics_hash`, with a line for each view, and the quadrics.
    `canonical`: the canonical document; kept quadrics that it needs are in the message's second blob.
    `keep`: `quadrics_hash` and the number of `quadrics`, with the quadrics.

    Kept quadrics that a body names and the message has not are asked for by `scene`, their id, in the reply.
    """
    started = time.perf_counter()
    limits, kept = message["limits"], blobs[1:]
    text, arrays = text_and_arrays(blobs[0], message["boundary"], limits["bytes of arrays"])
    answer: Callable[[], Reply]
    if message["do"] == "keep":
        answer = partial(_keep, parse_quadrics(text, arrays, most_quadrics=limits["quadrics"]))
    elif message["do"] == "read":
        part = Part.of(message.get("frame"), message.get("band"))
        document = read_document(text, arrays, part, most_quadrics=limits["quadrics"])
        camera, output = view_of(document, part)
        x0, y0, x1, y1 = camera.crop
        check_limits(limits, quadrics=document.quadric_count, pixels=(x1 - x0) * (y1 - y0))
        answer = partial(_read, document, camera, output)
    else:
        batch = parse_batch(text, arrays, most_quadrics=limits["quadrics"])
        pixels = batch.pixel_counts
        check_limits(limits, quadrics=batch.quadric_count, pixels=int(pixels.max()), frames=len(pixels))
        check_limits(limits, **{"pixels of a job": int(pixels.sum())})
        answer = partial(_canonical, batch, kept) if message["do"] == "canonical" else partial(_batch, batch)
    parsed = time.perf_counter()
    reply, results = answer()
    reply["timings_ms"] = {"parse": (parsed - started) * 1e3, "setup": (time.perf_counter() - parsed) * 1e3}
    return reply, results


def text_and_arrays(body: Blob, boundary: str | None, most_bytes: int) -> tuple[bytes, dict[str, NDArray[Any]]]:
    """The document's text, and the arrays that come with it where there is a boundary between parts.

    Raises:
        MultipartError: the parts are not what they should be.
        SceneError: the arrays are no .npz file.
        LimitError: they inflate to more than `most_bytes`.
    """
    if boundary is None:
        return body.read(), {}
    parts = parts_of(body.fileno(), boundary)
    if not {"scene"} <= parts.keys() <= {"scene", "arrays"}:
        raise MultipartError(f"the parts are {', '.join(parts) or 'none'}; {REMEDY}")
    arrays = read_npz(parts["arrays"], most_bytes) if "arrays" in parts else {}
    return parts["scene"].read(), arrays


def _read(document: Document | Batch, camera: Camera, output: Output) -> Reply:
    if document.scene is None:
        quadrics = document.resolve_quadrics()
        hashed, own, asked = quadrics_hash(quadrics), [Blob.of(quadrics_bytes(quadrics))], {}
    else:
        hashed, own, asked = document.scene[:_LONGEST_ID], [], {"scene": document.scene[:_LONGEST_ID]}
    reply = {"scene_hash": view_hash(hashed, camera, output), "quadrics_hash": hashed}
    return reply | asked, [Blob.of(view_line(hashed, camera, output)), *own]


def _batch(batch: Batch) -> Reply:
    if batch.scene is None:
        quadrics = batch.resolve_quadrics()
        hashed, own, asked = quadrics_hash(quadrics), [Blob.of(quadrics_bytes(quadrics))], {}
    else:
        hashed, own, asked = batch.scene[:_LONGEST_ID], [], {"scene": batch.scene[:_LONGEST_ID]}
    cameras, output = batch.views()
    views = Blob()
    with views.buffered() as stream:
        for camera in cameras:
            stream.write(view_line(hashed, camera, output))
    return {"frames": len(cameras), "quadrics_hash": hashed, **asked}, [views, *own]


def _canonical(batch: Batch, kept: list[Blob]) -> Reply:
    if batch.scene is not None and not kept:
        return {"scene": batch.scene[:_LONGEST_ID]}, []
    quadrics = quadrics_from(kept[0].read()) if kept else batch.resolve_quadrics()
    if kept and quadrics_hash(quadrics) != batch.scene:
        raise QuadricsFileError("the stored quadrics are damaged; keep the scene again")
    cameras, output = batch.views()
    text = (
        canonical_batch_bytes(quadrics, cameras, output)
        if batch.is_list
        else canonical_bytes(Scene(quadrics, cameras[0], output))
    )
    return {}, [Blob.of(text)]


def _keep(quadrics: Quadrics) -> Reply:
    return {"quadrics_hash": quadrics_hash(quadrics), "quadrics": len(quadrics)}, [Blob.of(quadrics_bytes(quadrics))]


def check_limits(limits: dict[str, int], **asked: int) -> None:
    """Refuse a document that asks for more than the limits, before arrays or pixels are allocated for it.

    Raises:
        LimitError: with the limit and the cost asked.
    """
    for what, count in asked.items():
        if count > limits[what]:
            raise LimitError(what, limits[what], count)


if __name__ == "__main__":
    serve(start, sys.argv[1:])
