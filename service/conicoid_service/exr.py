"""A rendered frame as OpenEXR bytes: the same frame gives the same bytes, whatever the number of threads."""

import io
from typing import TYPE_CHECKING, Any, BinaryIO, Final

import numpy as np
import OpenEXR
import orjson
from numpy.typing import NDArray

from conicoid import __version__
from conicoid.canonical import camera_document
from conicoid.scene import Camera, Output, Scene
from conicoid_service.bands import Window
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
Planes = dict[str, NDArray[Any]]

DEPTH_MEANING: Final = "Z, ZBack: planar, along the viewing direction; T: distance along the ray"


def set_threads(count: int) -> None:
    """How many threads compress; once per process, before the first image."""
    OpenEXR.set_global_thread_count(count)


def encode(frame: "Frame", scene: Scene, scene_hash: str) -> bytes:
    """The image as bytes; see `write`."""
    stream = io.BytesIO()
    write(stream, frame.planes, frame.window, scene.camera, scene.output, scene_hash)
    return stream.getvalue()


def write(
    stream: "BinaryIO | io.BytesIO", planes: Planes, window: Window, camera: Camera, output: Output, scene_hash: str
) -> None:
    """Write the image to an empty, seekable stream: scan lines, one part, no date.

    Args:
        stream: where the bytes go.
        planes: EXR channel name to a C-contiguous (h, w) array that is used in place: float32, for `id` uint32. N is
            written as HALF where `half_normals` says so, and may be rounded already.
        window: (x0, y0, x1, y1), half-open, where the planes lie in the whole image.
        camera: what the planes were made with, for the header.
        output: likewise.
        scene_hash: hex digest, see `conicoid.canonical.scene_hash`.
    """
    # OpenEXR.File puts its own objects into the dictionaries that it is given: both are made for it.
    header = _header(window, camera, output, scene_hash)
    OpenEXR.File(header, _channels(planes, output)).write(stream)


def _channels(planes: Planes, output: Output) -> Planes:
    if not output.half_normals:
        return dict(planes)
    return {
        name: plane.astype(np.float16, copy=False) if name.startswith("N.") else plane for name, plane in planes.items()
    }


def _header(window: Window, camera: Camera, output: Output, scene_hash: str) -> dict[str, Any]:
    x0, y0, x1, y1 = window
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
