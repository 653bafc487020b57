"""The render process: the only one that loads OpenCL, which may end it at any time."""

import os
import pickle
import sys
import time

from conicoid.scene import Scene
from conicoid_service import exr
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.cpus import usable_cpus
from conicoid_service.kernel_cache import take_slot
from conicoid_service.worker import Handler, Reply, serve


def start(configuration: Message) -> tuple[Handler, Message]:
    """Prepare the driver's surroundings, load it, build and launch the kernels: no request waits for a compiler.

    Raises:
        DeviceError: there is no usable device, or the kernels do not build on it.
    """
    threads = configuration["threads"] or usable_cpus()
    os.environ["POCL_MAX_PTHREAD_COUNT"] = str(threads)  # PoCL up to 6
    os.environ["POCL_CPU_MAX_CU_COUNT"] = str(threads)  # PoCL from 6 on
    take_slot(configuration["cache_dir"], after=configuration["after"])
    exr.set_threads(threads)

    from conicoid.engine import Renderer  # loads OpenCL, which reads its environment only once

    renderer = Renderer(configuration["device"])

    def render(message: Message, blobs: list[Blob]) -> Reply:
        scene: Scene = pickle.loads(blobs[0].read())  # noqa: S301  # written by the document process
        frame = renderer.render(scene)
        started = time.perf_counter()
        image = Blob()
        exr.write(image.file, frame, scene, message["scene_hash"])
        encode_ms = (time.perf_counter() - started) * 1e3
        timings = {"setup": frame.setup_ms, "cast": frame.cast_ms, "encode": encode_ms}
        return {"timings_ms": timings, "refined": frame.refined, "settled": frame.settled}, [image]

    return render, {"device": renderer.device.as_dict(), "threads": threads}


if __name__ == "__main__":
    serve(start, sys.argv[1:])
