"""Jobs spread over processes, each with a renderer of its own."""

import itertools
import multiprocessing
import os
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from functools import cache

from conicoid.engine import Renderer
from tests.stress.check import Result, check
from tests.stress.workload import Job


def in_processes(work: Iterator[Job], processes: int, pixels: int, seconds: float) -> Iterator[Result]:
    """Results as they come, until that many pixels are checked or that much time is over."""
    end = time.monotonic() + seconds
    spawn = multiprocessing.get_context("spawn")
    with (
        tempfile.TemporaryDirectory(prefix="conicoid-stress-") as folder,
        ProcessPoolExecutor(processes, spawn, own_cache, (folder,)) as pool,
    ):
        # A few jobs ahead, so that no process waits.
        running: set[Future[Result]] = {pool.submit(run, job) for job in itertools.islice(work, 2 * processes)}
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                result = future.result()
                pixels -= result.pixels
                yield result
                if pixels > 0 and time.monotonic() < end:
                    running.add(pool.submit(run, next(work)))


def own_cache(folder: str) -> None:
    """Kernels are compiled into a folder of this process alone: processes that share one have crashed."""
    os.environ["POCL_CACHE_DIR"] = tempfile.mkdtemp(dir=folder)


def run(job: Job) -> Result:
    """Checks one job in this process."""
    return check(job, renderer())


@cache
def renderer() -> Renderer:
    """This process's renderer."""
    return Renderer()
