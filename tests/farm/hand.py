"""A worker in the tests' own process, with child processes of their choice; `conicoid worker` has Celery around it."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from conicoid_service.farm.queues import QUEUES, connected
from conicoid_service.farm.station import Station
from conicoid_service.pipeline import Commands
from conicoid_service.settings import Settings

_LOOK_S = 0.02


@contextmanager
def working(settings: Settings, commands: Commands | None) -> Iterator[None]:
    """Render one unit of a farm at a time, meanwhile."""
    stopping, station = threading.Event(), Station(settings, commands)

    def work() -> None:
        with connected(settings) as connection:
            queues = [queue.bind(connection.default_channel) for queue in QUEUES.values()]
            while not stopping.is_set():
                message = next(filter(None, (queue.get(accept=["json"]) for queue in queues)), None)
                if message is None:
                    time.sleep(_LOOK_S)
                    continue
                _, body, _ = message.decode()
                station.execute(body, redelivered=message.delivery_info["redelivered"])
                message.ack()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        stopping.set()
        station.close()
        thread.join()
