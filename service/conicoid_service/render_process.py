"""The render process: the only one that loads OpenCL, which may end it at any time."""

import os
import sys
import time
from contextlib import ExitStack

from conicoid.canonical import quadrics_hash
from conicoid.errors import QuadricsFileError
from conicoid.quadrics_file import quadrics_from
from conicoid.scene import Quadrics, Scene
from conicoid_service import exr, joining
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.kernel_cache import take_slot
from conicoid_service.memory import limit_memory
from conicoid_service.views import view_from
from conicoid_service.worker import Handler, Reply, serve


class LastQuadrics:
    """The quadrics of the last frame: the next camera on them finds them here."""

    def __init__(self) -> None:
        self._hash = ""
        self._quadrics: Quadrics | None = None

    def quadrics(self, hashed: str, blob: Blob, *, stored: bool) -> Quadrics:
        """The quadrics in a blob, which is read only if they are others than last time.

        Raises:
            QuadricsFileError: the disk, where they were `stored`, has damaged them.
        """
        if self._quadrics is None or self._hash != hashed:
            self._quadrics = None  # before the others take their room
            quadrics = quadrics_from(blob.read())
            if stored and quadrics_hash(quadrics) != hashed:
                raise QuadricsFileError("the stored quadrics are damaged; submit the job, or keep the scene, again")
            self._quadrics, self._hash = quadrics, hashed
        return self._quadrics


def start(configuration: Message) -> tuple[Handler, Message]:
    """Prepare the driver's surroundings, load it, build and launch the kernels: no request waits for a compiler.

    Raises:
        DeviceError: there is no usable device, or the kernels do not build on it.
    """
    limit_memory(configuration["memory_limit"])
    threads = configuration["threads"]
    os.environ["POCL_MAX_PTHREAD_COUNT"] = str(threads)  # PoCL up to 6
    os.environ["POCL_CPU_MAX_CU_COUNT"] = str(threads)  # PoCL from 6 on
    take_slot(configuration["cache_dir"], after=configuration["after"])
    exr.set_threads(threads)

    from conicoid.engine import Renderer  # loads OpenCL, which reads its environment only once

    renderer = Renderer(configuration["device"])
    last = LastQuadrics()

    def handle(message: Message, blobs: list[Blob]) -> Reply:
        return join(message, blobs) if message["do"] == "join" else render(message, blobs)

    def render(message: Message, blobs: list[Blob]) -> Reply:
        view, quadrics = blobs
        stored = message["stored"]
        scene = Scene(last.quadrics(message["quadrics_hash"], quadrics, stored=stored), *view_from(view.read()))
        frame = renderer.render(scene)
        started = time.perf_counter()
        image = Blob()
        with image.buffered() as stream:
            exr.write(stream, frame.planes, frame.window, scene.camera, scene.output, message["scene_hash"])
        encode_ms = (time.perf_counter() - started) * 1e3
        timings = {"setup": frame.setup_ms, "cast": frame.cast_ms, "encode": encode_ms}
        x0, y0, x1, y1 = scene.camera.crop
        work = {"pixels": (x1 - x0) * (y1 - y0), "quadrics": len(scene.quadrics)}
        return {"timings_ms": timings, "refined": frame.refined, "settled": frame.settled, **work}, [image]

    return handle, {"device": renderer.device.as_dict(), "threads": threads}


def join(message: Message, blobs: list[Blob]) -> Reply:
    """The image of a frame from its bands, without OpenCL; the first blob is its view."""
    started = time.perf_counter()
    view, *bands = blobs
    with ExitStack() as on_error, ExitStack() as streams:
        image = on_error.enter_context(Blob())
        files = [streams.enter_context(blob.buffered()) for blob in (image, *bands)]
        joining.join(files[0], *view_from(view.read()), files[1:], message["quadrics_hash"])
        on_error.pop_all()
    return {"timings_ms": {"join": (time.perf_counter() - started) * 1e3}}, [image]


if __name__ == "__main__":
    serve(start, sys.argv[1:])
