"""The API's connection to RabbitMQ: one, used by one thread, made again after every error."""

import logging
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from kombu import Connection
from kombu.exceptions import KombuError

from conicoid_service.errors import BrokerError
from conicoid_service.farm.queues import DEAD, QUEUES, TASK, celery_app, connected, message_of, unit_of
from conicoid_service.jobs.records import Priority, Unit
from conicoid_service.settings import Settings

logger = logging.getLogger(__name__)


class Broker:
    """Sends units and looks at the queues. Whatever raises BrokerError, the next call connects again."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._app = celery_app(settings)
        self._open = ExitStack()
        self._connection: Connection | None = None

    def send(self, priority: Priority, units: Iterable[Unit]) -> int:
        """Send units, each safe at the broker before the next; how many were, fewer if it is lost meanwhile."""
        queue, count = QUEUES[priority], 0
        try:
            with self._using() as connection:
                producer = self._app.amqp.Producer(connection.default_channel, auto_declare=False)
                for unit in units:
                    self._app.send_task(
                        TASK,
                        kwargs=message_of(unit),
                        producer=producer,
                        exchange=queue.exchange,
                        routing_key=queue.routing_key,
                        retry=False,
                    )
                    count += 1
        except BrokerError as error:
            logger.warning("%s", error)
        return count

    def depth(self, priority: Priority) -> int:
        """How many units of a priority wait in the queue, apart from those that workers have."""
        with self._using() as connection:
            queue = QUEUES[priority].bind(connection.default_channel)
            count = int(queue.queue_declare().message_count)
            queue.queue_bind()  # somebody may have deleted it since, with its binding
            return count

    def connect(self) -> None:
        """Have a connection."""
        with self._using():
            pass

    def dead(self) -> tuple[Unit | None, Any] | None:
        """One of the units that were delivered too often, with what `forget` takes; (None, ...) is no unit of ours."""
        with self._using() as connection:
            message = DEAD.bind(connection.default_channel).get(accept=["json"])
            return None if message is None else (_unit(message), message)

    def forget(self, message: Any) -> None:
        """Take a dead unit out of its queue, where it comes back otherwise, at the latest after `close`."""
        with self._using():
            message.ack()

    def close(self) -> None:
        """Give the connection up."""
        self._connection = None
        self._open.close()

    @contextmanager
    def _using(self) -> Iterator[Connection]:
        try:
            if self._connection is None:
                self._connection = self._open.enter_context(connected(self._settings))
            yield self._connection
        except Exception as error:
            self._connection = None
            opened, self._open = self._open, ExitStack()
            # The connection's own context makes a BrokerError of what is the broker's fault.
            if not opened.__exit__(type(error), error, error.__traceback__):
                raise


def _unit(message: Any) -> Unit | None:
    try:
        _, kwargs, _ = message.decode()
        return unit_of(kwargs)
    except (ValueError, KeyError, TypeError, KombuError):
        logger.exception("the dead letters have one that is no unit")
        return None
