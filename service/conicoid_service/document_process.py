"""The document process: hostile bytes in, resolved scenes or canonical documents out. No OpenCL here."""

import pickle
import sys
import time
from typing import Any

from conicoid.canonical import canonical_bytes, scene_hash
from conicoid.document import Document, parse
from conicoid.errors import LimitError
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.worker import Handler, Reply, serve


def start(_: Message) -> tuple[Handler, Message]:
    """Nothing to prepare: importing was the work."""
    return handle, {}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    """Read the body in the first blob and give what `message["do"]` names: `read` or `canonical`."""
    started = time.perf_counter()
    document = parse(blobs[0].read())
    check_limits(document, message["limits"])
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
