"""Everyone who takes part, behind one face: a lap sets up or builds, casts, and tells both times."""

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from conicoid.engine import Renderer as Engine
from conicoid.scene import Precision, Scene
from conicoid_bench.compiled import Numba
from conicoid_bench.embree import EmbreeProcess
from conicoid_bench.engine import Conicoid
from conicoid_bench.mitsuba_shapes import Mitsuba
from conicoid_bench.picture import Job, Picture, Renderer
from conicoid_bench.vectorised import Vectorised
from conicoid_bench.whole import more_than_whole, moved_camera

# Above, a lap of NumPy takes seconds.
_MOST_NUMPY = 1000


class Entry(Protocol):
    """A contender on one scene."""

    def lap(self) -> tuple[float, float]:
        """Milliseconds until it can cast (set-up, build), and to cast."""

    def picture(self) -> Picture:
        """Of the same scene, with ids; not timed."""


class Contender(Protocol):
    """One renderer.

    Attributes:
        name: for tables.
        raced: whether it is timed; else it is only checked.
    """

    name: str
    raced: bool

    def why_not(self, scene: Scene) -> str | None:
        """Why it cannot render a scene, in a few words; None if it can."""

    def enter(self, scene: Scene) -> AbstractContextManager[Entry]:
        """Everything that depends on neither camera nor quadrics moving."""


class Ours:
    """The engine, asked for Z and N; set-up is everything per quadric, cast everything per pixel."""

    raced = True

    def __init__(self, engine: Engine, precision: Precision) -> None:
        self._engine, self._precision = engine, precision
        self.name = f"Conicoid {precision}"

    def why_not(self, scene: Scene) -> str | None:  # noqa: ARG002
        """It renders every scene."""
        return None

    @contextmanager
    def enter(self, scene: Scene) -> Iterator[Entry]:
        """Nothing is kept from one lap to the next."""
        yield _OurEntry(self._engine, scene, self._precision)


class _OurEntry:
    def __init__(self, engine: Engine, scene: Scene, precision: Precision) -> None:
        self._engine = engine
        self._asked = replace(scene, output=replace(scene.output, channels=("Z", "N"), precision=precision))
        self._with_ids = Conicoid(engine, precision).prepare(scene)

    def lap(self) -> tuple[float, float]:
        begin = time.perf_counter()
        frame = self._engine.render(self._asked)
        total = 1e3 * (time.perf_counter() - begin)
        return frame.setup_ms, total - frame.setup_ms

    def picture(self) -> Picture:
        return self._with_ids.picture(self._with_ids.run())


class InProcess:
    """A renderer of `bench error`, which here builds in every lap what depends on camera or quadrics."""

    def __init__(self, renderer: Renderer, raced: bool = True) -> None:
        self._renderer, self.name, self.raced = renderer, renderer.name, raced

    def why_not(self, scene: Scene) -> str | None:
        """What the renderer says."""
        return self._renderer.why_not(scene)

    @contextmanager
    def enter(self, scene: Scene) -> Iterator[Entry]:
        """Rays and buffers."""
        yield _Prepared(self._renderer.prepare(scene))


class _Prepared:
    def __init__(self, job: Job) -> None:
        self._job = job
        self._result: Any = None

    def lap(self) -> tuple[float, float]:
        times = [time.perf_counter()]
        self._job.build()
        times.append(time.perf_counter())
        self._result = self._job.run()
        times.append(time.perf_counter())
        return 1e3 * (times[1] - times[0]), 1e3 * (times[2] - times[1])

    def picture(self) -> Picture:
        return self._job.picture(self._job.run())


class Embree:
    """The program of bench/embree.

    Args:
        program: where it is.
    Raises:
        ImportError: it is not there.
    """

    name, raced = "Embree", True

    def __init__(self, program: Path) -> None:
        if not program.is_file():
            raise ImportError(f"{program} is not there; `make embree` builds it, with Debian's libembree-dev")
        self._program = program.resolve()

    def why_not(self, scene: Scene) -> str | None:
        """It takes whole ellipsoids seen from the origin."""
        return more_than_whole(scene) or moved_camera(scene)

    @contextmanager
    def enter(self, scene: Scene) -> Iterator[Entry]:
        """A process that has read the scene."""
        with EmbreeProcess(self._program, scene) as process:
            yield process


def contenders(engine: Engine, embree: Path) -> tuple[list[Contender], dict[str, str]]:
    """All that run here, ours first; and why the others do not."""
    found: list[Contender] = [Ours(engine, precision) for precision in ("exact", "float64", "float32")]
    found.append(InProcess(Vectorised(_MOST_NUMPY)))
    missing = {}
    others: dict[str, Callable[[], Contender]] = {
        "numba": lambda: InProcess(Numba()),
        "Mitsuba sphere": lambda: InProcess(Mitsuba("sphere")),
        "Mitsuba ellipsoids": lambda: InProcess(Mitsuba("ellipsoids"), raced=False),
        "Embree": lambda: Embree(embree),
    }
    for name, make in others.items():
        try:
            found.append(make())
        except ImportError as error:
            missing[name] = str(error)
    return found, missing
