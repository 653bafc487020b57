"""Embree, by the program that bench/embree is the source of: scene in a file, commands and times through pipes."""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Self

import numpy as np

from conicoid.scene import Scene
from conicoid_bench.picture import Picture
from conicoid_bench.whole import records


class PeerFailed(Exception):
    """The program stopped, or answered something else than it was asked."""


class EmbreeProcess:
    """One scene in one process; a context that ends it.

    Args:
        program: the built `embree_ellipsoids`.
        configuration: Embree's own, as in "isa=avx2".
    """

    def __init__(self, program: Path, scene: Scene, configuration: str = "") -> None:
        self._program = program
        self._folder = TemporaryDirectory()
        self._ids = np.concatenate([[0], scene.quadrics.id]).astype(np.uint32)
        self._shape = scene.camera.height, scene.camera.width
        path = Path(self._folder.name) / "scene"
        path.write_bytes(scene_file(scene))
        self._process = subprocess.Popen(
            [program, path, configuration], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()
        self._folder.cleanup()

    def lap(self) -> tuple[float, float]:
        """Milliseconds to build and to cast."""
        build, cast = (float(word) for word in self._ask("lap").split())
        return build, cast

    def picture(self) -> Picture:
        """Cast once more, with ids."""
        path = Path(self._folder.name) / "picture"
        self._ask(f"picture {path}")
        return read_picture(path.read_bytes(), self._shape, self._ids)

    def _ask(self, command: str) -> str:
        assert self._process.stdin
        assert self._process.stdout
        try:
            print(command, file=self._process.stdin, flush=True)
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            raise PeerFailed(f"{self._program} ended with status {self._process.wait()}")
        return answer


def scene_file(scene: Scene) -> bytes:
    """What the program reads."""
    camera = scene.camera
    header = np.array([len(scene.quadrics), camera.width, camera.height, 0], dtype="<i4").tobytes()
    lens = np.array([camera.fx, camera.fy, camera.cx, camera.cy], dtype="<f4").tobytes()
    return header + lens + records(scene).astype("<f4").tobytes()


def read_picture(data: bytes, shape: tuple[int, int], ids: np.ndarray) -> Picture:
    """What the program writes: (h, w) depths and (h, w, 3) normals, float32, and (h, w) uint32 places in `ids`."""
    pixels = shape[0] * shape[1]
    values = np.frombuffer(data, dtype="<f4", count=4 * pixels)
    numbers = np.frombuffer(data, dtype="<u4", offset=16 * pixels)
    return Picture(values[:pixels].reshape(shape), ids[numbers].reshape(shape), values[pixels:].reshape(*shape, 3))
