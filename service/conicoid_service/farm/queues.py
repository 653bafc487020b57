"""What the API and its workers agree upon: queues, messages, and how Celery treats them."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

from amqp.exceptions import MessageNacked
from celery import Celery
from kombu import Connection, Exchange, Queue
from kombu.exceptions import KombuError

from conicoid import __version__
from conicoid_service.entity_tags import ENGINE
from conicoid_service.errors import BrokerError
from conicoid_service.jobs.records import PRIORITIES, Priority, Unit
from conicoid_service.settings import Settings

TASK: Final = "conicoid.unit"
# Deliveries of a unit whose workers end, beyond the first.
REDELIVERIES: Final = 3
CONNECT_S: Final = 5.0
HEARTBEAT_S: Final = 10
# A child that takes longer has gone astray: what it does has a deadline of its own. Less than the half hour after
# which RabbitMQ takes a message back.
ASTRAY_S: Final = 900

_ANSWER_S: Final = 10.0
_EXCHANGE: Final = Exchange("conicoid", "direct")

DEAD: Final = Queue("conicoid.dead", _EXCHANGE, "conicoid.dead", queue_arguments={"x-queue-type": "quorum"})


def queue_name(priority: Priority) -> str:
    """The queue of a priority; each version has its own, so that no worker gets what it would render differently."""
    return f"conicoid.{__version__}.{priority}"


QUEUES: Final[Mapping[Priority, Queue]] = {
    priority: Queue(
        queue_name(priority),
        _EXCHANGE,
        queue_name(priority),
        queue_arguments={
            "x-queue-type": "quorum",
            "x-delivery-limit": REDELIVERIES,
            "x-dead-letter-exchange": _EXCHANGE.name,
            "x-dead-letter-routing-key": DEAD.routing_key,
        },
    )
    for priority in PRIORITIES
}


def message_of(unit: Unit) -> dict[str, Any]:
    """A unit as a task's keyword arguments."""
    return {"job": unit.job_id, "number": unit.number, "band": unit.band, "engine": ENGINE}


def unit_of(message: Mapping[str, Any]) -> Unit:
    """The unit of a message.

    Raises:
        KeyError, TypeError: it is not one of `message_of`.
    """
    unit = Unit(message["job"], message["number"], message["band"])
    if [type(value) for value in (unit.job_id, unit.number, unit.band)] != [str, int, int]:
        raise TypeError(f"no unit: {message!r:.200}")
    return unit


@contextmanager
def connected(settings: Settings) -> Iterator[Connection]:
    """A connection to the broker, with the queues declared, on which no heartbeat needs to be sent.

    Raises:
        BrokerError: it cannot be had, or is lost while it is used.
    """
    connection = celery_app(settings).connection_for_write(heartbeat=0, connect_timeout=CONNECT_S)
    connection.transport_options |= {"read_timeout": _ANSWER_S, "write_timeout": _ANSWER_S}
    try:
        connection.connect()
        for queue in (*QUEUES.values(), DEAD):
            queue.bind(connection.default_channel).declare()
        yield connection
    except (KombuError, MessageNacked, OSError, *connection.connection_errors, *connection.channel_errors) as error:
        raise BrokerError(f"the broker: {type(error).__name__}: {error}"[:300]) from error
    finally:
        connection.collect(socket_timeout=1)


def celery_app(settings: Settings) -> Celery:
    """Celery, set up so that a unit is done again wherever it is lost, and what ends workers goes to `DEAD`."""
    app = Celery("conicoid", broker=settings.broker_url, set_as_current=False)
    app.conf.update(
        accept_content=["json"],
        task_serializer="json",
        task_ignore_result=True,
        # A unit is acknowledged once the store has it; one whose worker ends is delivered again.
        task_acks_late=True,
        task_reject_on_worker_lost=True,
        task_acks_on_timeout=False,
        task_acks_on_failure=False,  # what meets a defect goes to `DEAD`, and from there another way
        task_time_limit=ASTRAY_S,
        worker_prefetch_multiplier=1,
        worker_cancel_long_running_tasks_on_connection_loss=True,
        # Quorum queues on at least one disk before `send` returns.
        task_default_queue_type="quorum",
        task_queues=list(QUEUES.values()),
        task_default_queue=queue_name("normal"),
        broker_transport_options={"confirm_publish": True, "read_timeout": 30, "write_timeout": 30},
        broker_connection_timeout=CONNECT_S,
        broker_heartbeat=HEARTBEAT_S,
        broker_connection_retry_on_startup=True,
        broker_connection_max_retries=None,
        # Neither remote control nor events: the store says how everything is.
        worker_enable_remote_control=False,
        worker_send_task_events=False,
        worker_consumer="conicoid_service.farm.worker:UnitConsumer",
        worker_hijack_root_logger=False,
        worker_redirect_stdouts=False,
    )
    return app
