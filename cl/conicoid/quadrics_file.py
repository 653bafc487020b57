"""Quadrics as bytes: arrays in the safetensors format, names in its metadata; nothing in it is ever executed."""

from dataclasses import fields
from itertools import pairwise
from typing import Any, Final

import numpy as np
import orjson
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from conicoid.errors import QuadricsFileError
from conicoid.scene import KeptSet, Quadrics
from conicoid.shapes import SHAPES

_VERSION: Final = "conicoid quadrics 1"
# Shapes of the arrays: n quadrics, m matrices, k clips.
_ARRAYS: Final[dict[str, tuple[Any, tuple[int | str, ...]]]] = {
    "shape": (np.uint8, ("n",)),
    "radii": (np.float64, ("n", 3)),
    "matrix_row": (np.int32, ("n",)),
    "matrix": (np.float64, ("m", 4, 4)),
    "world_from_object": (np.float64, ("n", 3, 4)),
    "id": (np.uint32, ("n",)),
    "z_range": (np.float64, ("n", 2)),
    "capped": (np.bool_, ("n",)),
    "clip": (np.float64, ("k", 4)),
    "clip_start": (np.int32, ("n + 1",)),
}


def quadrics_bytes(quadrics: Quadrics) -> bytes:
    """The bytes from which `quadrics_from` makes the same quadrics."""
    named = {
        "format": _VERSION,
        "name": orjson.dumps({str(index): name for index, name in quadrics.name.items()}).decode(),
        "sets": orjson.dumps([[kept.start, kept.stop, kept.name] for kept in quadrics.sets]).decode(),
    }
    return save({name: np.ascontiguousarray(getattr(quadrics, name)) for name in _ARRAYS}, named)


def quadrics_from(data: bytes) -> Quadrics:
    """The quadrics in bytes that `quadrics_bytes` made.

    Raises:
        QuadricsFileError: they are something else, or damaged: no index in the result leads out of its array.
    """
    try:
        arrays, about = load(data), _metadata(data)
        if about.get("format") != _VERSION or arrays.keys() != _ARRAYS.keys():
            raise QuadricsFileError("not a file of quadrics, or one of another version")
        name = {int(index): str(text) for index, text in orjson.loads(about["name"]).items()}
        sets = tuple(KeptSet(int(start), int(stop), text) for start, stop, text in orjson.loads(about["sets"]))
    except (SafetensorError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise QuadricsFileError(f"not a file of quadrics: {error}") from None
    _check_arrays(arrays)
    quadrics = Quadrics(**arrays, name=name, sets=sets)
    _check_indexes(quadrics)
    return quadrics


def _metadata(data: bytes) -> dict[str, str]:
    size = int.from_bytes(data[:8], "little")
    metadata: dict[str, str] = orjson.loads(data[8 : 8 + size]).get("__metadata__", {})
    return metadata


def _check_arrays(arrays: dict[str, NDArray[Any]]) -> None:
    """Types and shapes."""
    n, m, k = (len(np.atleast_1d(arrays[name])) for name in ("shape", "matrix", "clip"))
    sizes = {"n": n, "m": m, "k": k, "n + 1": n + 1}
    for name, (dtype, shape) in _ARRAYS.items():
        wanted = tuple(sizes[size] if isinstance(size, str) else size for size in shape)
        if arrays[name].dtype != dtype or arrays[name].shape != wanted:
            raise QuadricsFileError(f"{name} is {arrays[name].dtype} {arrays[name].shape}, not {dtype} {wanted}")


def _check_indexes(quadrics: Quadrics) -> None:
    rows, starts = quadrics.matrix_row, quadrics.clip_start
    is_form = quadrics.shape == next(shape.code for shape in SHAPES if shape.name == "quadric")
    right = (
        (quadrics.shape < len(SHAPES)).all()
        and ((rows >= 0) == is_form).all()
        and (rows < len(quadrics.matrix)).all()
        and starts[0] == 0
        and starts[-1] == len(quadrics.clip)
        and (starts[1:] >= starts[:-1]).all()  # a difference of int32 could wrap
        and all(0 <= kept.start < kept.stop <= len(quadrics) for kept in quadrics.sets)
        and all(one.stop <= following.start for one, following in pairwise(quadrics.sets))
        and all(0 <= index < len(quadrics) for index in quadrics.name)
    )
    if not right:
        raise QuadricsFileError("its indexes lead out of its arrays")


assert {one.name for one in fields(Quadrics)} == {*_ARRAYS, "name", "sets"}  # noqa: S101  # nothing is left out
