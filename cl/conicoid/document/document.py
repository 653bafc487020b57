"""A scene document, from bytes to a resolved scene."""

from collections.abc import Callable
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid.collector import paused_collector
from conicoid.document.camera import resolve_cameras
from conicoid.document.json_text import read_exact, read_fast
from conicoid.document.problems import Problems
from conicoid.document.records import Record
from conicoid.document.references import Arrays, explain_unused, refer
from conicoid.document.resolve import resolve_output, resolve_quadrics
from conicoid.document.scene_fields import BATCH, KEPT, SCENE
from conicoid.document.set_fields import MOST_ID
from conicoid.document.variants import Group
from conicoid.errors import Problem, SceneError
from conicoid.scene import Camera, Output, Quadrics, Scene


@dataclass(frozen=True)
class Document:
    """A valid scene document as columns.

    Attributes:
        quadrics: in groups of one shape and the same keys; empty where `scene` names them.
        camera: a group of one.
        output: key to a column of length 1, for the keys given.
        scene: the id of quadrics kept elsewhere, which the document has in place of its own; None if it has its own.
    """

    quadrics: list[Group]
    camera: Group
    output: dict[str, Any]
    scene: str | None = None

    @property
    def quadric_count(self) -> int:
        """Quadrics to be rendered."""
        return sum(map(len, self.quadrics))

    def view(self) -> tuple[Camera, Output]:
        """The camera and the output, with every number derived and every default filled in."""
        (camera,) = resolve_cameras(self.camera)
        return camera, resolve_output(self.output)

    def views(self) -> tuple[list[Camera], Output]:
        """The same as those of a `Batch`."""
        camera, output = self.view()
        return [camera], output

    def resolve_quadrics(self) -> Quadrics:
        """The document's own quadrics with every number derived and every default filled in."""
        return resolve_quadrics(self.quadrics)

    def resolve(self, kept: Quadrics | None = None) -> Scene:
        """The scene's arrays with every number derived and every default filled in.

        Args:
            kept: the quadrics that `scene` names; where it is None, the document's own.
        """
        return Scene(self.resolve_quadrics() if kept is None else kept, *self.view())


@dataclass(frozen=True)
class Batch:
    """A valid scene document of one camera or many, as columns.

    Attributes:
        quadrics, output, scene: as in `Document`.
        cameras: in groups of one projection and the same keys.
        is_list: whether the document gives `cameras`.
    """

    quadrics: list[Group]
    cameras: list[Group]
    output: dict[str, Any]
    scene: str | None
    is_list: bool

    @property
    def quadric_count(self) -> int:
        """Quadrics to be rendered."""
        return sum(map(len, self.quadrics))

    @property
    def pixel_counts(self) -> NDArray[np.int64]:
        """(n,) pixels to be rendered in each frame, in no order."""
        return np.concatenate([_pixel_counts(group) for group in self.cameras])

    def views(self) -> tuple[list[Camera], Output]:
        """The cameras of all frames, in order, and the output that they share."""
        numbered = [pair for group in self.cameras for pair in zip(group.index, resolve_cameras(group), strict=True)]
        return [camera for _, camera in sorted(numbered, key=itemgetter(0))], resolve_output(self.output)

    def resolve_quadrics(self) -> Quadrics:
        """The document's own quadrics with every number derived and every default filled in."""
        return resolve_quadrics(self.quadrics)


def parse(body: bytes, arrays: Arrays | None = None, *, most_quadrics: int = MOST_ID) -> Document:
    """Read and check a scene document.

    Args:
        body: JSON as UTF-8.
        arrays: what `"@name"` stands for in its sets; they are read, and perhaps kept, but not changed.
        most_quadrics: the quadrics that are allowed, elements of sets included.

    Raises:
        SceneError: it breaks the format; with everything found wrong, up to `problems.MOST_PROBLEMS`.
        LimitError: it has more than `most_quadrics`, which is refused before their values are looked at.
    """
    columns = _checked(lambda _: SCENE, body, arrays, most_quadrics)
    (camera,) = columns["camera"]
    (scene,) = columns.get("scene", [None])
    return Document(columns.get("quadrics", []), camera, columns.get("output", {}), scene)


def parse_batch(body: bytes, arrays: Arrays | None = None, *, most_quadrics: int = MOST_ID) -> Batch:
    """Read and check a scene document that gives `camera` or `cameras`; see `parse`."""
    columns = _checked(_one_or_many, body, arrays, most_quadrics)
    (scene,) = columns.get("scene", [None])
    is_list = "cameras" in columns
    cameras = columns["cameras"] if is_list else columns["camera"]
    return Batch(columns.get("quadrics", []), cameras, columns.get("output", {}), scene, is_list)


def _one_or_many(tree: Any) -> Record:
    return BATCH if isinstance(tree, dict) and "cameras" in tree else SCENE


def parse_quadrics(body: bytes, arrays: Arrays | None = None, *, most_quadrics: int = MOST_ID) -> Quadrics:
    """Read, check and resolve the quadrics of a document that need have nothing else; see `parse`.

    A camera and an output are checked too where they are given.
    """
    return resolve_quadrics(_checked(lambda _: KEPT, body, arrays, most_quadrics)["quadrics"])


def _checked(record: Callable[[Any], Record], body: bytes, arrays: Arrays | None, most_quadrics: int) -> dict[str, Any]:
    """The columns of a document that is right, by the record for its tree."""
    try:
        with paused_collector():
            return _read(record, body, arrays or {}, most_quadrics)
    except MemoryError:
        message = "does not fit in memory; give fewer quadrics"
        raise SceneError([Problem("", message, "scene-json")]) from None


def _read(record: Callable[[Any], Record], body: bytes, arrays: Arrays, most_quadrics: int) -> dict[str, Any]:
    tree = read_fast(body)
    columns, _ = _columns(record(tree), tree, arrays, most_quadrics)
    if columns is None:
        # Wrong, or more than the fast reader can vouch for: only the exact reader knows which, and where.
        tree = read_exact(body)
        columns, unused = _columns(record(tree), tree, arrays, most_quadrics)
        if columns is None:
            problems = Problems()
            record(tree).explain(tree, "", problems)
            explain_unused(unused, problems)
            problems.raise_any()
            raise AssertionError("a document is wrong, but nothing in it is")
    return columns


def _columns(record: Record, tree: Any, arrays: Arrays, most_quadrics: int) -> tuple[dict[str, Any] | None, set[str]]:
    """The document's columns, None if anything is wrong, and the arrays that it does not use."""
    unused = arrays.keys() - refer(tree, arrays, most_quadrics)
    return None if unused else record.column([tree]), unused


def _pixel_counts(cameras: Group) -> NDArray[np.int64]:
    """(n,) pixels of each camera's crop, or of its whole image."""
    columns = cameras.columns
    if "crop" in columns:
        x0, y0, x1, y1 = columns["crop"].T
        return np.asarray((x1 - x0) * (y1 - y0), np.int64)
    return np.asarray(columns["width"] * columns["height"], np.int64)
