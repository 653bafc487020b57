"""A rendered frame as OpenEXR bytes: the same frame gives the same bytes, whatever the number of threads."""

import io
from typing import TYPE_CHECKING, Any, BinaryIO, Final

import numpy as np
import OpenEXR
import orjson
from numpy.typing import NDArray

from conicoid import __version__
from conicoid.canonical import camera_document
from conicoid.scene import Output, Scene
from conicoid_service.camera_matrices import world_to_camera, world_to_ndc

if TYPE_CHECKING:  # the engine loads OpenCL, which writing an image does not need
    from conicoid.engine import Frame

COMPRESSION: Final = {
    "none": OpenEXR.NO_COMPRESSION,
    "rle": OpenEXR.RLE_COMPRESSION,
    "zip": OpenEXR.ZIP_COMPRESSION,
    "zips": OpenEXR.ZIPS_COMPRESSION,
    "piz": OpenEXR.PIZ_COMPRESSION,
    "zstd": OpenEXR.ZSTD_COMPRESSION,
}
DEPTH_MEANING: Final = "Z, ZBack: planar, along the viewing direction; T: distance along the ray"


def set_threads(count: int) -> None:
    """How many threads compress; once per process, before the first image."""
    OpenEXR.set_global_thread_count(count)


def encode(frame: "Frame", scene: Scene, scene_hash: str) -> bytes:
    """The image as bytes; see `write`."""
    stream = io.BytesIO()
    write(stream, frame, scene, scene_hash)
    return stream.getvalue()


def write(stream: "BinaryIO | io.BytesIO", frame: "Frame", scene: Scene, scene_hash: str) -> None:
    """Write the image to an empty, seekable stream: scan lines, one part, no date.

    Args:
        stream: where the bytes go.
        frame: its planes are used in place; FLOAT, `id` as UINT, N as HALF where `half_normals` says so.
        scene: the camera and output that the frame was made with, for the header.
        scene_hash: hex digest, see `conicoid.canonical.scene_hash`.
    """
    # OpenEXR.File puts its own objects into the dictionaries that it is given: both are made for it.
    header = _header(frame, scene, scene_hash)
    OpenEXR.File(header, _channels(frame, scene.output)).write(stream)


def _channels(frame: "Frame", output: Output) -> dict[str, NDArray[Any]]:
    if not output.half_normals:
        return dict(frame.planes)
    return {name: plane.astype(np.float16) if name.startswith("N.") else plane for name, plane in frame.planes.items()}


def _header(frame: "Frame", scene: Scene, scene_hash: str) -> dict[str, Any]:
    camera, output = scene.camera, scene.output
    x0, y0, x1, y1 = frame.window
    return {
        "type": OpenEXR.scanlineimage,
        "compression": COMPRESSION[output.compression],
        "displayWindow": ((0, 0), (camera.width - 1, camera.height - 1)),
        "dataWindow": ((x0, y0), (x1 - 1, y1 - 1)),
        "worldToCamera": world_to_camera(camera),
        "worldToNDC": world_to_ndc(camera),
        "software": f"conicoid {__version__}",
        "conicoid/version": __version__,
        "conicoid/sceneHash": scene_hash,
        "conicoid/precision": output.precision,
        "conicoid/depth": DEPTH_MEANING,
        "conicoid/backgroundDepth": output.background_depth,
        "conicoid/normalSpace": output.normal_space,
        "conicoid/normalSide": output.normal_side,
        # Exact where the M44f attributes are rounded.
        "conicoid/camera": orjson.dumps(camera_document(camera)).decode(),
    }
