"""A render process without OpenCL: arbitrary planes for any scene; a quadric's name asks for a fault."""

import os
import sys
import time
from pathlib import Path

from conicoid.scene import Scene
from conicoid_service import exr
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.render_process import LastQuadrics, join
from conicoid_service.views import view_from
from conicoid_service.worker import Handler, Reply, serve
from tests.service.scenes import frame

DEVICE = {"platform": "Fake", "version": "1", "name": "none", "compute_units": 1, "global_memory": 1}


def start(_: Message) -> tuple[Handler, Message]:
    return handle, {"device": DEVICE, "threads": 1}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    if message["do"] == "join":
        return join(message, blobs)
    view, quadrics = blobs
    read = LastQuadrics().quadrics(message["quadrics_hash"], quadrics, stored=message["stored"])
    scene = Scene(read, *view_from(view.read()))
    words = scene.quadrics.name.get(0, "").split()
    match words:
        case ["abort"]:
            os.abort()
        case ["hang"]:
            time.sleep(3600)
        case ["sleep", seconds]:
            time.sleep(float(seconds))
        case ["until", path]:
            while not Path(path).exists():
                time.sleep(0.01)
        case ["defect"]:
            raise ZeroDivisionError("a secret of the server's")
    image = Blob.of(exr.encode(frame(scene), scene, message["scene_hash"]))
    return {
        "timings_ms": {"setup": 1.0, "cast": 2.0, "encode": 3.0},
        "refined": 7,
        "settled": 4,
        "pixels": 1200,
        "quadrics": 1,
    }, [image]


if __name__ == "__main__":
    serve(start, sys.argv[1:])
