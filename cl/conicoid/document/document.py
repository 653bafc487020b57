"""A scene document, from bytes to a resolved scene."""

from dataclasses import dataclass
from typing import Any

from conicoid.collector import paused_collector
from conicoid.document.camera import resolve_cameras
from conicoid.document.json_text import read_exact, read_fast
from conicoid.document.problems import Problems
from conicoid.document.references import Arrays, check_count, explain_unused, refer
from conicoid.document.resolve import resolve_output, resolve_quadrics
from conicoid.document.scene_fields import SCENE
from conicoid.document.set_fields import MOST_ID
from conicoid.document.variants import Group
from conicoid.errors import Problem, SceneError
from conicoid.scene import Scene


@dataclass(frozen=True)
class Document:
    """A valid scene document as columns.

    Attributes:
        quadrics: in groups of one shape and the same keys.
        camera: a group of one.
        output: key to a column of length 1, for the keys given.
    """

    quadrics: list[Group]
    camera: Group
    output: dict[str, Any]

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

    def resolve(self) -> Scene:
        """The scene's arrays with every number derived and every default filled in."""
        (camera,) = resolve_cameras(self.camera)
        return Scene(resolve_quadrics(self.quadrics), camera, resolve_output(self.output))


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
    try:
        with paused_collector():
            return _parse(body, arrays or {}, most_quadrics)
    except MemoryError:
        message = "does not fit in memory; give fewer quadrics"
        raise SceneError([Problem("", message, "scene-json")]) from None


def _parse(body: bytes, arrays: Arrays, most_quadrics: int) -> Document:
    columns, _ = _columns(read_fast(body), arrays, most_quadrics)
    if columns is None:
        # Wrong, or more than the fast reader can vouch for: only the exact reader knows which, and where.
        tree = read_exact(body)
        columns, unused = _columns(tree, arrays, most_quadrics)
        if columns is None:
            problems = Problems()
            SCENE.explain(tree, "", problems)
            explain_unused(unused, problems)
            problems.raise_any()
            raise AssertionError("a document is wrong, but nothing in it is")
    (camera,) = columns["camera"]
    return Document(columns["quadrics"], camera, columns.get("output", {}))


def _columns(tree: Any, arrays: Arrays, most_quadrics: int) -> tuple[dict[str, Any] | None, set[str]]:
    """The document's columns, None if anything is wrong, and the arrays that it does not use."""
    check_count(tree, most_quadrics)
    unused = arrays.keys() - refer(tree, arrays)
    return None if unused else SCENE.column([tree]), unused
