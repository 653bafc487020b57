"""What a malformed document is, and the sound document around each mistake."""

from collections.abc import Mapping
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from conicoid.document import Document, parse, read_npz

MOST_BYTES = 10_000
LENS = '"width": 64, "height": 48, "fov_y": 40'
LOOK_AT = '"look_at": {"eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]}'
IDENTITY = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"


class Case(NamedTuple):
    """A document with one mistake.

    Attributes:
        name: what is wrong, unique among all cases.
        body: the document.
        pointer: the place of the one problem it has.
        code: the code of that problem.
        schema: whether JSON Schema refuses it too; None where the body is not even JSON.
        arrays: what comes beside the document, by name or as an .npz file; None for nothing.
    """

    name: str
    body: bytes
    pointer: str
    code: str
    schema: bool | None = True
    arrays: Mapping[str, NDArray[Any]] | bytes | None = None

    def parse(self) -> Document:
        """Read it as the service does."""
        arrays = self.arrays
        return parse(self.body, read_npz(BytesIO(arrays), MOST_BYTES) if isinstance(arrays, bytes) else arrays)

    def npz(self) -> bytes:
        """The arrays as a file."""
        if isinstance(self.arrays, bytes):
            return self.arrays
        file, arrays = BytesIO(), dict[str, Any](self.arrays or {})
        np.savez(file, **arrays)
        return file.getvalue()


def document(quadrics: str = "[]", camera: str = f"{{{LENS}}}", rest: str = "") -> bytes:
    """A document whose parts are given as JSON text; `rest` starts with a comma."""
    return f'{{"conicoid": 1, "quadrics": {quadrics}, "camera": {camera}{rest}}}'.encode()


def sphere(keys: str) -> bytes:
    """A document whose quadrics[1] is a sphere with these keys."""
    return shaped("sphere", keys)


def shaped(shape: str, keys: str = "") -> bytes:
    """A document whose quadrics[1] has this shape and these keys."""
    return document(f'[{{"shape": "sphere"}}, {{"shape": "{shape}"{", " if keys else ""}{keys}}}]')


def camera(keys: str) -> bytes:
    """A document whose camera is a pinhole with these keys besides width, height and fov_y."""
    return document(camera=f"{{{LENS}, {keys}}}")


def lens(keys: str) -> bytes:
    """A document whose camera has exactly these keys."""
    return document(camera=f"{{{keys}}}")


def output(keys: str) -> bytes:
    """A document whose output has these keys."""
    return document(rest=f', "output": {{{keys}}}')
