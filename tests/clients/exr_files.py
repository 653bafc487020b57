"""Small OpenEXR files with known content."""

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray


def exr_bytes(
    channels: Mapping[str, NDArray[Any]],
    *,
    at: tuple[int, int] = (0, 0),
    display: tuple[int, int] | None = None,
    attributes: Mapping[str, Any] | None = None,
) -> bytes:
    """A file with these channels; the data window's corner is `at`, the display window is `display` (w, h)."""
    h, w = next(iter(channels.values())).shape
    width, height = display or (w, h)
    x, y = at
    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "displayWindow": ((0, 0), (width - 1, height - 1)),
        "dataWindow": ((x, y), (x + w - 1, y + h - 1)),
        **(attributes or {}),
    }
    stream = io.BytesIO()
    OpenEXR.File(header, dict(channels)).write(stream)
    return stream.getvalue()


def half_hit(h: int = 4, w: int = 6) -> dict[str, NDArray[Any]]:
    """Z and N of an image whose left half is hit: depth 1 to 2 from the top row down, normal +z; the rest is empty."""
    hit = np.zeros((h, w), bool)
    hit[:, : w // 2] = True
    depth = np.broadcast_to(np.linspace(1, 2, h, dtype=np.float32)[:, None], (h, w))
    zero = np.zeros((h, w), np.float32)
    return {
        "Z": np.where(hit, depth, np.float32(np.inf)),
        "N.X": zero,
        "N.Y": zero.copy(),
        "N.Z": hit.astype(np.float32),
    }
