"""The document process: hostile bytes in, resolved scenes or canonical documents out. No OpenCL here."""

import pickle
import sys
import time
from typing import Any

from conicoid.canonical import canonical_bytes, scene_hash
from conicoid.document import Document, parse, read_npz
from conicoid.errors import LimitError
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.errors import MultipartError
from conicoid_service.multipart import REMEDY, parts_of
from conicoid_service.worker import Handler, Reply, serve


def start(_: Message) -> tuple[Handler, Message]:
    """Nothing to prepare: importing was the work."""
    return handle, {}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    """Read the body in the first blob and give what `message["do"]` names: `read` or `canonical`."""
    started = time.perf_counter()
    document = read(blobs[0], message["boundary"], message["limits"])
    parsed = time.perf_counter()
    scene = document.resolve()
    reply: dict[str, Any] = {}
    if message["do"] == "canonical":
        result = Blob.of(canonical_bytes(scene))
    else:
        reply["scene_hash"] = scene_hash(scene)
        result = Blob()
        pickle.dump(scene, result.file, protocol=pickle.HIGHEST_PROTOCOL)
    reply["timings_ms"] = {"parse": (parsed - started) * 1e3, "setup": (time.perf_counter() - parsed) * 1e3}
    return reply, [result]


def read(body: Blob, boundary: str | None, limits: dict[str, int]) -> Document:
    """The document in a body, and the arrays that come with it where there is a boundary between parts.

    Raises:
        MultipartError: the parts are not what they should be.
        SceneError: the document or the arrays break the format.
        LimitError: they ask for more than the limits.
    """
    arrays = {}
    if boundary is None:
        text = body.read()
    else:
        parts = parts_of(body.fileno(), boundary)
        if not {"scene"} <= parts.keys() <= {"scene", "arrays"}:
            raise MultipartError(f"the parts are {', '.join(parts) or 'none'}; {REMEDY}")
        text = parts["scene"].read()
        if "arrays" in parts:
            arrays = read_npz(parts["arrays"], limits["bytes of arrays"])
    document = parse(text, arrays, most_quadrics=limits["quadrics"])
    check_limits(document, limits)
    return document


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
