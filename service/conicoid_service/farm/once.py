"""A single unit, for farms that start a process for each: Kubernetes jobs, or another queueing system."""

import logging
import os
from collections.abc import Sequence

from conicoid_service.farm.queues import QUEUES, connected
from conicoid_service.farm.station import Station
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
    with connected(settings) as connection:
        for priority in queues:
            message = QUEUES[priority].bind(connection.default_channel).get(accept=["json"])
            if message is not None:
                break
        else:
            logger.info("no unit waits")
            return 0
        station = Station(settings)
        try:
            _, body, _ = message.decode()
            outcome = station.execute(body, redelivered=message.delivery_info["redelivered"])
            message.ack()
        finally:
            station.close()
    return os.EX_CONFIG if outcome == "refused" else 0
