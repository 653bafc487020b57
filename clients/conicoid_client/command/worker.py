"""`conicoid worker`: renders what the API of a farm sends."""

import argparse
from typing import TYPE_CHECKING

from conicoid_client.command.connect import settings
from conicoid_client.command.report import Failure, UsageError

if TYPE_CHECKING:
    from conicoid_service.jobs.records import Priority


def run(options: argparse.Namespace) -> None:
    """Take units until SIGINT or SIGTERM; the units in hand are ended first."""
    configuration = settings(options.config)
    if not configuration.farm:
        raise Failure(
            "a worker needs the farm's CONICOID_BROKER_URL, CONICOID_DATABASE_URL and CONICOID_OBJECT_STORE; "
            "without a farm conicoid serve renders itself"
        )
    try:
        from conicoid_service.farm.once import work_once
        from conicoid_service.farm.worker import work
    except ModuleNotFoundError as error:
        raise Failure(f"{error.name} is missing; install conicoid[farm]") from None
    from conicoid_service.errors import ServiceError
    from conicoid_service.telemetry.logs import configure

    configure(configuration.log_format, "info")
    queues = _queues(options.queues)
    try:
        if options.once:
            status = work_once(configuration, queues)
        else:
            status = work(configuration, queues, options.processes or configuration.render_processes)
    except ServiceError as error:
        raise Failure(str(error)) from None
    if status:
        raise Failure("the worker has ended; its log above says why")


def _queues(text: str) -> "list[Priority]":
    from conicoid_service.jobs.records import PRIORITIES

    names = text.split(",")
    queues = [priority for priority in PRIORITIES if priority in names]
    if len(queues) != len(names):
        raise UsageError(f"--queues {text}: is no list of {', '.join(PRIORITIES)}; write one like high,normal")
    return sorted(queues, key=names.index)
