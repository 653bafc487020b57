"""The document process: hostile bytes in, resolved scenes or canonical documents out. No OpenCL here."""

import pickle
import sys
import time
from functools import partial
from typing import Any, Final

from numpy.typing import NDArray

from conicoid.canonical import canonical_bytes, quadrics_hash, view_hash
from conicoid.document import Document, parse, parse_quadrics, read_npz
from conicoid.errors import LimitError
from conicoid.scene import Quadrics
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.errors import MultipartError
from conicoid_service.multipart import REMEDY, parts_of
from conicoid_service.worker import Handler, Reply, serve

_LONGEST_ID: Final = 100  # of the ids that a body may name; no id is as long


def start(_: Message) -> tuple[Handler, Message]:
    """Nothing to prepare: importing was the work."""
    return handle, {}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    """Answer with what `message["do"]` names, for the body in the first blob.

    `read`: `scene_hash` and `quadrics_hash`, with the pickled camera and output, and the pickled quadrics.
    `canonical`: the canonical document; kept quadrics that it needs are in the message's second blob.
    `keep`: `quadrics_hash` and the number of `quadrics`, with the pickled quadrics.

    Kept quadrics that a body names and the message has not are asked for by `scene`, their id, in the reply.
    """
    started = time.perf_counter()
    limits, kept = message["limits"], blobs[1:]
    text, arrays = text_and_arrays(blobs[0], message["boundary"], limits["bytes of arrays"])
    if message["do"] == "keep":
        answer = partial(_keep, parse_quadrics(text, arrays, most_quadrics=limits["quadrics"]))
    else:
        document = parse(text, arrays, most_quadrics=limits["quadrics"])
        check_limits(document, limits)
        answer = partial(_canonical, document, kept) if message["do"] == "canonical" else partial(_read, document)
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


def _read(document: Document) -> Reply:
    if document.scene is None:
        scene = document.resolve()
        quadrics, own = quadrics_hash(scene.quadrics), [_pickled(scene.quadrics)]
        asked, view = {}, (scene.camera, scene.output)
    else:
        quadrics, own = document.scene[:_LONGEST_ID], []
        asked, view = {"scene": quadrics}, document.view()
    reply = {"scene_hash": view_hash(quadrics, *view), "quadrics_hash": quadrics}
    return reply | asked, [_pickled(view), *own]


def _canonical(document: Document, kept: list[Blob]) -> Reply:
    if document.scene is not None and not kept:
        return {"scene": document.scene[:_LONGEST_ID]}, []
    quadrics = pickle.loads(kept[0].read()) if kept else None  # noqa: S301  # written by this process
    return {}, [Blob.of(canonical_bytes(document.resolve(quadrics)))]


def _keep(quadrics: Quadrics) -> Reply:
    return {"quadrics_hash": quadrics_hash(quadrics), "quadrics": len(quadrics)}, [_pickled(quadrics)]


def _pickled(value: Any) -> Blob:
    blob = Blob()
    pickle.dump(value, blob.file, protocol=pickle.HIGHEST_PROTOCOL)
    return blob


def check_limits(document: Document, limits: dict[str, int]) -> None:
    """Refuse a document that asks for more than the limits, before arrays or pixels are allocated for it.

    Raises:
        LimitError: with the limit and the cost asked.
    """
    for what, asked in (("quadrics", document.quadric_count), ("pixels", document.pixel_count)):
        if asked > limits[what]:
            raise LimitError(what, limits[what], asked)


if __name__ == "__main__":
    serve(start, sys.argv[1:])
