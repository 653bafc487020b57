"""Job stores for tests, and jobs to put into them."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from conicoid_service.jobs.database import Database
from conicoid_service.jobs.outbox import Outbox
from conicoid_service.jobs.records import Claim, StoredImage
from conicoid_service.jobs.store import JobStore, NewJob
from conicoid_service.jobs.upkeep import Upkeep
from conicoid_service.jobs.work import Work
from tests.service.jobs import places

LIFETIME_MS = 1000
BAND_PIXELS = 1000


class Store:
    """All that is done to one database, by one server."""

    def __init__(self, folder: Path, holder: str = "me", owner_frame_limit: int = 1000) -> None:
        self.database = Database(places.of(folder).get("database_url") or folder / "jobs.sqlite")
        self.jobs = JobStore(self.database, LIFETIME_MS, owner_frame_limit, BAND_PIXELS)
        self.work = Work(self.database, holder, LIFETIME_MS)
        self.upkeep = Upkeep(self.database)
        self.outbox = Outbox(self.database, LIFETIME_MS)

    def take(self, now_ms: int = 0) -> Claim:
        """A claim, which there must be."""
        claim = self.work.claim(now_ms)
        assert claim is not None
        return claim

    def submit(self, frames: int = 1, owner: str = "", now_ms: int = 0, **changes: Any) -> str:
        """The id of a new job."""
        return self.jobs.create(new_job(frames, owner, **changes), now_ms)[0].id


@contextmanager
def opened(folder: Path, **arguments: Any) -> Iterator[Store]:
    store = Store(folder, **arguments)
    try:
        yield store
    finally:
        store.database.close()


def new_job(frames: int = 1, owner: str = "", crop: tuple[int, ...] = (0, 0, 20, 10), **changes: Any) -> NewJob:
    """Of frames with a window in pixels."""
    output = {"precision": "exact"}
    views = [
        json.dumps({"camera": {"frame": k, "crop": crop}, "output": output, "scene_hash": f"hash {k}"}).encode()
        for k in range(frames)
    ]
    values: dict[str, Any] = {"quadrics_hash": "quadrics", "digest": "digest", "idempotency_key": None, **changes}
    return NewJob(owner=owner, frames_total=frames, views=views, **values)


def image(tag: str = "tag", size: int = 10) -> StoredImage:
    return StoredImage(tag, size, "sha256", "scene hash", 0, 0)
