"""Views on their way to the render process, or on the disk until then: a camera and an output as a line of JSON."""

import numpy as np
import orjson

from conicoid.canonical import camera_document, output_document, view_hash
from conicoid.scene import Camera, Output


def view_line(quadrics_hash: str, camera: Camera, output: Output) -> bytes:
    """Canonical camera and output with the hash of the scene that they make of the quadrics, one line."""
    scene_hash = view_hash(quadrics_hash, camera, output)
    view = {"camera": camera_document(camera), "output": output_document(output), "scene_hash": scene_hash}
    return orjson.dumps(view, option=orjson.OPT_APPEND_NEWLINE)


def view_from(line: bytes) -> tuple[Camera, Output]:
    """The same camera and output, bit for bit; the line is one that `view_line` made."""
    view = orjson.loads(line)
    camera, output = view["camera"], view["output"]
    del camera["convention"]  # OpenGL's, as everywhere inside
    camera |= {"world_from_camera": np.array(camera["world_from_camera"]), "crop": tuple(camera["crop"])}
    output |= {"channels": tuple(output["channels"]), "background_depth": float(output["background_depth"])}
    return Camera(**({"far": np.inf} | camera)), Output(**output)
