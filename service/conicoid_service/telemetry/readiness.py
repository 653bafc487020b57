"""Whether a request that comes now would be answered."""

import asyncio
import logging
import time
from collections.abc import Mapping
from typing import Final

from starlette.datastructures import State

from conicoid_service.errors import NotReadyError, ServiceError, StoppingError, StorageError
from conicoid_service.pool import Pool

_DISK_S: Final = 2.0  # for a small file; and how long its answer stands, since whoever asks needs no key

logger = logging.getLogger(__name__)


class Readiness:
    """The checks behind `/readyz`.

    Attributes:
        draining: set as soon as the server is told to end.
    """

    def __init__(self, state: State) -> None:
        """Check an application's `state.pipeline` and, where there is one, its job store `state.jobs`."""
        self._state = state
        self.draining = False
        self._disk: ServiceError | None = None
        self._disk_checked = -_DISK_S
        self._disk_checking = asyncio.Lock()

    async def checks(self) -> dict[str, ServiceError | None]:
        """Each check's name and why it fails, None if it does not; the first one that fails is the reason."""
        children: Mapping[str, Pool] = self._state.pipeline.children
        found = {"draining": StoppingError("the service is shutting down") if self.draining else None}
        return {
            **found,
            **{name: _child(child) for name, child in children.items()},
            "queue": _queue(children["render"]),
            **({"storage": await self._storage()} if self._state.jobs else {}),
        }

    async def _storage(self) -> ServiceError | None:
        async with self._disk_checking:
            if time.monotonic() - self._disk_checked >= _DISK_S:
                try:
                    await asyncio.wait_for(self._state.jobs.check(), _DISK_S)
                except StorageError as error:
                    self._disk = error
                except TimeoutError:  # an OSError, too
                    self._disk = StorageError(f"the disk has not taken a small file in {_DISK_S:g} s")
                except OSError:
                    logger.exception("the disk does not take a small file")
                    self._disk = StorageError("the disk does not take a small file; the log says why")
                else:
                    self._disk = None
                self._disk_checked = time.monotonic()
        return self._disk


def _child(child: Pool) -> ServiceError | None:
    if child.ready:
        return None
    return child.failure or NotReadyError(f"the {child.name} process is starting; requests wait for it")


def _queue(child: Pool) -> ServiceError | None:
    return None if child.room else NotReadyError("as many requests wait as may")
