"""Views on their way to the render process, or on the disk until then: a camera and an output as a line of JSON."""

import orjson

from conicoid.canonical import camera_document, output_document, view_hash
from conicoid.document import parse
from conicoid.scene import Camera, Output


def view_line(quadrics_hash: str, camera: Camera, output: Output) -> bytes:
    """Canonical camera and output with the hash of the scene that they make of the quadrics, one line."""
    scene_hash = view_hash(quadrics_hash, camera, output)
    view = {"camera": camera_document(camera), "output": output_document(output), "scene_hash": scene_hash}
    return orjson.dumps(view, option=orjson.OPT_APPEND_NEWLINE)


def view_from(line: bytes) -> tuple[Camera, Output]:
    """The same camera and output, bit for bit.

    Raises:
        SceneError: the line is damaged.
    """
    view = orjson.loads(line)
    document = {"conicoid": 1, "scene": "", "camera": view["camera"], "output": view["output"]}
    return parse(orjson.dumps(document)).view()
