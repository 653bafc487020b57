"""Metrics that are read from their owners at the moment of a scrape, in place of being counted on the way."""

import inspect
import logging
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric

Readings = Mapping[str, float]
Reader = Callable[[], Readings | Awaitable[Readings]]

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Watched:
    """A metric of one label; "" is its name where it has none."""

    kind: Literal["gauge", "counter"]
    help: str
    label: str = ""


WATCHED: Final[Mapping[str, Watched]] = {
    "conicoid_queue_requests": Watched("gauge", "Requests that wait for a render process", "class"),
    "conicoid_queue_oldest_seconds": Watched("gauge", "How long the oldest of them waits", "class"),
    "conicoid_queue_limit": Watched("gauge", "Interactive requests that may wait"),
    "conicoid_document_queue_requests": Watched("gauge", "Requests that wait for the document process"),
    "conicoid_processes": Watched("gauge", "Child processes that are alive and warm", "process"),
    "conicoid_losses": Watched("counter", "Child processes that died or were killed with a request in them", "cause"),
    "conicoid_retries": Watched("counter", "Requests that were tried once more on a fresh process"),
    "conicoid_images_kept_bytes": Watched("gauge", "Bytes of images in memory"),
    "conicoid_jobs": Watched("gauge", "Jobs in the store", "state"),
    "conicoid_frames": Watched("gauge", "Frames of the jobs in the store", "state"),
    "conicoid_frames_ended": Watched("counter", "Frames that ended since the start", "outcome"),
    "conicoid_units_sent": Watched("gauge", "Units of a farm that were sent to its broker and not taken", "priority"),
    "conicoid_store_bytes": Watched("gauge", "Bytes of images on the disk"),
    "conicoid_store_limit_bytes": Watched("gauge", "Bytes of images that the disk may take"),
}


class Readers:
    """Who is asked for the watched metrics; those that nobody registered do not appear."""

    def __init__(self) -> None:
        self._readers: dict[str, Reader] = {}

    def watch(self, name: str, read: Reader) -> None:
        """Have a metric of `WATCHED` read by `read`: its value by label value, or by "" without a label."""
        if name not in WATCHED:
            raise KeyError(name)
        self._readers[name] = read

    async def read(self) -> list[Metric]:
        """All of them now; one that cannot be read is left out, and the log says why."""
        found: list[Metric] = []
        for name, reader in self._readers.items():
            try:
                readings = reader()
                found.append(_family(name, await readings if inspect.isawaitable(readings) else readings))
            except Exception:  # a scrape is wanted most when something is broken
                logger.exception("the metric %s cannot be read", name)
        return found


def _family(name: str, readings: Readings) -> Metric:
    about = WATCHED[name]
    kind = GaugeMetricFamily if about.kind == "gauge" else CounterMetricFamily
    family = kind(name, about.help, labels=[about.label] if about.label else None)
    for value_of_label, value in readings.items():
        family.add_metric([value_of_label] if about.label else [], value)
    return family
