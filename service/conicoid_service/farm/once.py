"""A single unit, for farms that start a process for each: Kubernetes jobs, or another queueing system."""

import logging
import os
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Any

from kombu import Connection

from conicoid_service.errors import UnavailableError
from conicoid_service.farm.queues import QUEUES, connected
from conicoid_service.farm.station import Outcome, Station
from conicoid_service.jobs.records import Priority
from conicoid_service.settings import Settings, forget_secrets

logger = logging.getLogger(__name__)


def work_once(settings: Settings, queues: Sequence[Priority]) -> int:
    """Render the first unit of the first queue that has one.

    Returns:
        The exit status: 0 if the unit has ended, nobody wants it any more, or there is none; else it is sent again.
    Raises:
        BrokerError: the broker cannot be reached, or was lost before it knew that the unit has ended.
    """
    forget_secrets()
    with ExitStack() as opened:
        connection = opened.enter_context(connected(settings))
        message = next(filter(None, (_first(connection, priority) for priority in queues)), None)
        if message is None:
            logger.info("no unit waits")
            return 0
        try:
            outcome = _render(settings, message)
        except Exception as error:
            opened.pop_all()  # this is not the connection's fault; it ends with the process, and the unit comes back
            raise UnavailableError(f"the unit cannot be rendered here: {error}") from error
        message.ack()
    return os.EX_CONFIG if outcome == "unable" else 0


def _first(connection: Connection, priority: Priority) -> Any:
    return QUEUES[priority].bind(connection.default_channel).get(accept=["json"])


def _render(settings: Settings, message: Any) -> Outcome:
    station = Station(settings)
    try:
        _, body, _ = message.decode()
        return station.execute(body, redelivered=message.delivery_info["redelivered"])
    finally:
        station.close()
