"""What a scene and its arrays are sent as."""

import io
import json
from collections.abc import Mapping
from typing import Any
from zipfile import ZipFile

Scene = bytes | Mapping[str, Any]
Arrays = bytes | Mapping[str, Any]
Body = bytes | Mapping[str, tuple[str | None, bytes, str]]  # JSON, or the parts of multipart/form-data


def json_bytes(scene: Scene) -> bytes:
    """The document as JSON text; what is text already stays as it is.

    Raises:
        ValueError: it has a number that JSON cannot say.
    """
    if isinstance(scene, bytes):
        return scene
    return json.dumps(scene, allow_nan=False, separators=(",", ":")).encode()


def body(scene: bytes, arrays: Arrays | None) -> Body:
    """The body of a request: the document alone, or with the arrays that it names."""
    if arrays is None:
        return scene
    npz = arrays if isinstance(arrays, bytes) else _npz(arrays)
    return {
        "scene": (None, scene, "application/json"),
        "arrays": ("arrays.npz", npz, "application/octet-stream"),
    }


def _npz(arrays: Mapping[str, Any]) -> bytes:
    """What `numpy.savez` would write, which cannot take every name.

    Raises:
        ValueError: an array holds Python objects.
    """
    import numpy as np

    file = io.BytesIO()
    with ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asanyarray(array), allow_pickle=False)
    return file.getvalue()
