"""A scene document, from bytes to a resolved scene."""

from dataclasses import dataclass
from typing import Any

from conicoid.collector import paused_collector
from conicoid.document.camera import resolve_cameras
from conicoid.document.json_text import read_exact, read_fast
from conicoid.document.problems import Problems
from conicoid.document.records import Record
from conicoid.document.references import Arrays, explain_unused, refer
from conicoid.document.resolve import resolve_output, resolve_quadrics
from conicoid.document.scene_fields import KEPT, SCENE
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

    @property
    def pixel_count(self) -> int:
        """Pixels to be rendered: the crop's, or the whole image's."""
        columns = self.camera.columns
        if "crop" in columns:
            x0, y0, x1, y1 = columns["crop"][0].tolist()
            return int((x1 - x0) * (y1 - y0))
        return int(columns["width"][0] * columns["height"][0])

    def view(self) -> tuple[Camera, Output]:
        """The camera and the output, with every number derived and every default filled in."""
        (camera,) = resolve_cameras(self.camera)
        return camera, resolve_output(self.output)

    def resolve(self, kept: Quadrics | None = None) -> Scene:
        """The scene's arrays with every number derived and every default filled in.

        Args:
            kept: the quadrics that `scene` names; where it is None, the document's own.
        """
        return Scene(resolve_quadrics(self.quadrics) if kept is None else kept, *self.view())


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
    columns = _checked(SCENE, body, arrays, most_quadrics)
    (camera,) = columns["camera"]
    (scene,) = columns.get("scene", [None])
    return Document(columns.get("quadrics", []), camera, columns.get("output", {}), scene)


def parse_quadrics(body: bytes, arrays: Arrays | None = None, *, most_quadrics: int = MOST_ID) -> Quadrics:
    """Read, check and resolve the quadrics of a document that need have nothing else; see `parse`.

    A camera and an output are checked too where they are given.
    """
    return resolve_quadrics(_checked(KEPT, body, arrays, most_quadrics)["quadrics"])


def _checked(record: Record, body: bytes, arrays: Arrays | None, most_quadrics: int) -> dict[str, Any]:
    """The columns of a document that is right."""
    try:
        with paused_collector():
            return _read(record, body, arrays or {}, most_quadrics)
    except MemoryError:
        message = "does not fit in memory; give fewer quadrics"
        raise SceneError([Problem("", message, "scene-json")]) from None


def _read(record: Record, body: bytes, arrays: Arrays, most_quadrics: int) -> dict[str, Any]:
    columns, _ = _columns(record, read_fast(body), arrays, most_quadrics)
    if columns is None:
        # Wrong, or more than the fast reader can vouch for: only the exact reader knows which, and where.
        tree = read_exact(body)
        columns, unused = _columns(record, tree, arrays, most_quadrics)
        if columns is None:
            problems = Problems()
            record.explain(tree, "", problems)
            explain_unused(unused, problems)
            problems.raise_any()
            raise AssertionError("a document is wrong, but nothing in it is")
    return columns


def _columns(record: Record, tree: Any, arrays: Arrays, most_quadrics: int) -> tuple[dict[str, Any] | None, set[str]]:
    """The document's columns, None if anything is wrong, and the arrays that it does not use."""
    unused = arrays.keys() - refer(tree, arrays, most_quadrics)
    return None if unused else record.column([tree]), unused
