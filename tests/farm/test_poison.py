"""A frame that ends every worker that takes it: it fails, says why, and takes no other frame with it."""

import os
import signal
import time
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread

import psycopg

from tests.farm.farm import Farm
from tests.farm.jobs import FRAMES, Job, batch

POISON = 37
DELIVERIES = 4  # the first, and as many more as the queue lets there be


def poisoned(database_url: str, killed: list[int], over: Event) -> None:
    """Kill the process that renders the frame, each time that one does."""
    with psycopg.connect(database_url, autocommit=True) as connection:
        while not over.is_set():
            query = "SELECT holder FROM frames WHERE number = %s AND state = 'running'"
            for (holder,) in connection.execute(query, [POISON]):
                pid = int(holder.split("-")[-2])  # host, process, chance
                with suppress(ProcessLookupError):
                    if pid not in killed:
                        os.kill(pid, signal.SIGKILL)
                        killed.append(pid)
            time.sleep(0.005)


def test_frame_that_ends_its_workers_fails_alone(tmp_path: Path, environment: dict[str, str]) -> None:
    document = batch()
    document["cameras"][POISON] |= {"width": 2400, "height": 1440}  # long enough to be caught
    killed: list[int] = []
    over = Event()
    with Farm(tmp_path, environment) as farm, Job(farm.api.url, document) as job:
        watch = Thread(target=poisoned, args=(environment["CONICOID_DATABASE_URL"], killed, over))
        watch.start()
        try:
            job.wait_for(FRAMES)
        finally:
            over.set()
            watch.join()
        now, frames = job.now(), job.frames()
        assert (now["state"], now["frames_done"], now["frames_failed"]) == ("failed", FRAMES - 1, 1)
        assert [frame["frame"] for frame in frames if frame["state"] != "succeeded"] == [POISON]
        assert frames[POISON]["error"]["code"] == "render-crashed"
        assert f"{DELIVERIES} times" in frames[POISON]["error"]["detail"]
        assert len(killed) == DELIVERIES
        assert all(worker.process.runs() for worker in farm.workers)
