"""Tells whoever watches a job that something of it has changed."""

import asyncio
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager


class Bell:
    """For one event loop; who watches the same job from another process has to look by itself."""

    def __init__(self) -> None:
        self._watching: defaultdict[str, set[asyncio.Event]] = defaultdict(set)

    def ring(self, job_id: str) -> None:
        """Wake all who watch a job."""
        for heard in self._watching.get(job_id, ()):
            heard.set()

    def ring_all(self) -> None:
        """Wake everybody."""
        for job_id in self._watching:
            self.ring(job_id)

    @contextmanager
    def watching(self, job_id: str) -> Iterator[asyncio.Event]:
        """An event that is set when the job changes; whoever waits for it clears it before looking at the job."""
        heard = asyncio.Event()
        self._watching[job_id].add(heard)
        try:
            yield heard
        finally:
            self._watching[job_id].discard(heard)
            if not self._watching[job_id]:
                del self._watching[job_id]
