"""The API's connection to RabbitMQ: one, used by one thread, made again after every error."""

import logging
from collections.abc import Iterable
from typing import Any, Final

from kombu.exceptions import KombuError

from conicoid_service.errors import BrokerError
from conicoid_service.farm.queues import CONNECT_S, DEAD, QUEUES, TASK, celery_app, message_of, unit_of
from conicoid_service.jobs.records import Priority, Unit
from conicoid_service.settings import Settings

_ANSWER_S: Final = 10.0

logger = logging.getLogger(__name__)


class Broker:
    """Sends units and looks at the queues. Every method may raise BrokerError, after which the next one reconnects."""

    def __init__(self, settings: Settings) -> None:
        self._app = celery_app(settings)
        self._connection: Any = None
        self._producer: Any = None

    def send(self, priority: Priority, units: Iterable[Unit]) -> int:
        """Send units, each on the broker's disk before the next; how many were."""
        queue, count = QUEUES[priority], 0
        try:
            self._connect()
            for unit in units:
                self._app.send_task(
                    TASK,
                    kwargs=message_of(unit),
                    producer=self._producer,
                    exchange=queue.exchange,
                    routing_key=queue.routing_key,
                    retry=False,
                    declare=[],
                )
                count += 1
        except self._errors() as error:
            self._lost(error)
        return count

    def depth(self, priority: Priority) -> int:
        """How many units of a priority wait in the queue, apart from those that workers have."""
        try:
            self._connect()
            return int(QUEUES[priority].bind(self._connection.default_channel).queue_declare().message_count)
        except self._errors() as error:
            self._lost(error)
            raise BrokerError(_reason(error)) from error

    def dead(self) -> list[tuple[Unit | None, Any]]:
        """Some of the units that were delivered too often, with what `forget` takes; None is no unit of ours."""
        found: list[tuple[Unit | None, Any]] = []
        try:
            self._connect()
            queue = DEAD.bind(self._connection.default_channel)
            while len(found) < 100 and (message := queue.get(accept=["json"])) is not None:
                found.append((_unit(message), message))
        except self._errors() as error:
            self._lost(error)
            raise BrokerError(_reason(error)) from error
        return found

    def forget(self, message: Any) -> None:
        """Take a dead unit out of its queue, where it comes back otherwise."""
        try:
            message.ack()
        except self._errors() as error:
            self._lost(error)
            raise BrokerError(_reason(error)) from error

    def close(self) -> None:
        """Give the connection up."""
        connection, self._connection = self._connection, None
        if connection is not None:
            connection.collect(socket_timeout=1)

    @property
    def connected(self) -> bool:
        """Whether the last that was done succeeded."""
        return self._connection is not None

    def _connect(self) -> None:
        if self._connection is None:
            connection = self._app.connection_for_write(heartbeat=0, connect_timeout=CONNECT_S)
            connection.transport_options |= {"read_timeout": _ANSWER_S, "write_timeout": _ANSWER_S}
            try:
                connection.connect()
                for queue in (*QUEUES.values(), DEAD):
                    queue.bind(connection.default_channel).declare()
                self._producer = self._app.amqp.Producer(connection.default_channel, auto_declare=False)
            except BaseException:
                connection.collect(socket_timeout=1)
                raise
            self._connection = connection

    def _errors(self) -> tuple[type[Exception], ...]:
        transport = self._app.connection_for_write()
        return (KombuError, OSError, *transport.connection_errors, *transport.channel_errors)

    def _lost(self, error: Exception) -> None:
        logger.warning("the broker is lost (%s)", _reason(error))
        self.close()


def _unit(message: Any) -> Unit | None:
    try:
        _, kwargs, _ = message.decode()
        return unit_of(kwargs)
    except (ValueError, KeyError, TypeError, KombuError):
        logger.exception("the dead letters have one that is no unit")
        return None


def _reason(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"[:200]
