"""`conicoid worker`: Celery, whose children each render one unit at a time."""

import logging
import os
import socket
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

from celery import Task, signals
from celery.worker import state
from celery.worker.consumer import Consumer
from celery.worker.request import Request

from conicoid_service.cpus import usable_cpus
from conicoid_service.farm.queues import QUEUES, TASK, celery_app
from conicoid_service.farm.station import Station
from conicoid_service.farm.watch import Watch
from conicoid_service.jobs.records import Priority
from conicoid_service.settings import Settings, forget_secrets

logger = logging.getLogger(__name__)


class UnitConsumer(Consumer):
    """Celery's consumer without the queues for delayed messages, of which there are none."""

    class Blueprint(Consumer.Blueprint):
        """What it is made of."""

        default_steps: Final = [step for step in Consumer.Blueprint.default_steps if "delayed_delivery" not in step]


class UnitTask(Task):
    """Renders the units that one child of the worker gets, on the station that it made when it began."""

    name = TASK
    Request = "conicoid_service.farm.worker:UnitRequest"
    settings: Settings
    watch: Watch
    station: Station

    def run(self, **message: Any) -> str:
        """Render the unit of a message; see `Station.execute`."""
        redelivered = bool(self.request.delivery_info["redelivered"])
        return self.station.execute(message, redelivered=redelivered)


class UnitRequest(Request):
    """A delivered unit, as the worker's first process sees it."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        # Not overridden: Celery makes a subclass of this class, with a method of its own.
        on_success: Callable[..., None] = super().__getattribute__("on_success")
        self.on_success = partial(self._counted, on_success)

    def _counted(self, on_success: Callable[..., None], answer: tuple[bool, Any, float], **kwargs: Any) -> None:
        """Count it; a worker that cannot render what is asked ends, so that somebody looks at it."""
        failed, returned, seconds = answer
        outcome = str(returned).strip("'")  # it comes as its `repr`
        if not failed:
            self.task.watch.count(outcome, seconds)
        if outcome == "unable":
            state.should_stop = os.EX_CONFIG
        on_success(answer, **kwargs)

    def on_failure(self, *args: Any, **kwargs: Any) -> None:
        """Count what ended its child, or met a defect."""
        self.task.watch.count("failed")
        super().on_failure(*args, **kwargs)


def work(settings: Settings, queues: Sequence[Priority], processes: int) -> int:
    """Render what the farm's API sends, until SIGTERM or SIGINT; the units in hand are ended.

    Args:
        settings: of the farm.
        queues: priorities of the units that this worker takes.
        processes: how many units are rendered at a time, each with its share of the CPUs.
    Returns:
        The exit status: 0 after an orderly end.
    """
    forget_secrets()
    threads = settings.threads or max(1, usable_cpus() // processes)
    app = celery_app(settings)
    UnitTask.settings = replace(settings, render_processes=1, threads=threads)
    UnitTask.watch = Watch(settings.worker_port)
    app.register_task(UnitTask())
    signals.worker_ready.connect(UnitTask.watch.follow, weak=False)
    signals.worker_process_init.connect(_open_station, weak=False)
    signals.worker_process_shutdown.connect(_close_station, weak=False)
    worker = app.Worker(
        hostname=f"conicoid-{os.getpid()}@{socket.gethostname()}",
        concurrency=processes,
        queues=[QUEUES[priority].name for priority in queues],
        pool_cls="prefork",
        without_gossip=True,
        without_mingle=True,
        without_heartbeat=True,
        quiet=True,
    )
    worker.start()
    return int(worker.exitcode or 0)


def _open_station(**_: Any) -> None:
    """In a child: its kernels are compiled while it waits for its first unit."""
    UnitTask.station = Station(UnitTask.settings)


def _close_station(**_: Any) -> None:
    UnitTask.station.close()
