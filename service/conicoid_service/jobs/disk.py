"""Everything of the job store that lies on the disk, and the one thread that works on it."""

import asyncio
import errno
import logging
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Final, ParamSpec, TypeVar

from sqlalchemy.exc import OperationalError

from conicoid_service.blob import Blob
from conicoid_service.errors import StorageError, StoreError
from conicoid_service.images import Image
from conicoid_service.jobs.database import Database, disk_refuses
from conicoid_service.jobs.folder import Folder
from conicoid_service.jobs.holder import Holder
from conicoid_service.jobs.image_shelf import ImageShelf
from conicoid_service.jobs.store import JobStore
from conicoid_service.jobs.upkeep import Upkeep
from conicoid_service.jobs.work import Work
from conicoid_service.settings import Settings

P = ParamSpec("P")
T = TypeVar("T")

RETRY_S: Final = 1.0
_REFUSALS: Final = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO, errno.EMFILE}

logger = logging.getLogger(__name__)


class Disk:
    """The data folder, opened: `jobs.sqlite`, `images/`, `quadrics/` and `holders/`.

    Attributes:
        trouble: why the disk refused what was last written to it; None if it took it.
    Raises:
        StoreError: it cannot be opened.
    """

    def __init__(self, settings: Settings) -> None:
        root, lifetime_ms = settings.data_dir, round(settings.result_lifetime_s * 1e3)
        try:
            root.mkdir(mode=0o700, parents=True, exist_ok=True)
            self.images, self.quadrics = Folder(root / "images"), Folder(root / "quadrics")
            self.holder = Holder(root / "holders")
        except OSError as error:
            raise StoreError(
                f"{root}: jobs cannot be kept here ({error.strerror}); give a folder that can be written to as "
                "`data_dir`"
            ) from None
        try:
            self._database = Database(root / "jobs.sqlite")
        except StoreError:
            self.holder.close()
            raise
        self.jobs = JobStore(self._database, lifetime_ms, settings.owner_frame_limit)
        self.work = Work(self._database, self.holder.name, lifetime_ms)
        self.upkeep = Upkeep(self._database)
        self.shelf = ImageShelf(self.images, self.upkeep)
        self.trouble: str | None = None
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="job-store")

    async def do(self, step: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Have the thread take a step.

        Raises:
            StorageError: the disk refuses; the same step may succeed later.
        """
        working = self._thread.submit(step, *args, **kwargs)
        try:
            return await asyncio.wrap_future(working)
        except asyncio.CancelledError:
            working.add_done_callback(_close_files)  # nobody will
            raise
        except (OperationalError, OSError) as error:
            self.trouble = _refusal(error)
            if self.trouble is None:
                raise
            raise StorageError(f"the disk does not take it ({self.trouble}); try again later") from error

    async def insist(self, step: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Have the thread take a step, however long the disk refuses."""
        while True:
            try:
                return await self.do(step, *args, **kwargs)
            except StorageError as error:
                logger.warning("%s", error)
                await asyncio.sleep(RETRY_S)

    def check(self) -> None:
        """Write and remove a small file.

        Raises:
            OSError: the disk does not take it.
        """
        with Blob.of(b"conicoid\n") as blob:
            self.images.write("check", blob)
        self.images.remove("check")
        self.trouble = None

    def remove_quadrics(self, older_than_ms: int) -> None:
        """Remove the quadrics that no job needs."""
        needed = self.upkeep.needed_quadrics()
        for name in list(self.quadrics.names(older_than_ms)):
            if name not in needed:
                self.quadrics.remove(name)

    def close(self) -> None:
        """End the thread and give everything up."""
        self._thread.shutdown()
        self._database.close()
        self.holder.close()


def _close_files(done: "Future[Any]") -> None:
    """Close the files that a step opened."""
    if done.cancelled() or done.exception() is not None:
        return
    result = done.result()
    for one in result if isinstance(result, tuple) else (result,):
        if isinstance(one, Blob):
            one.close()
        elif isinstance(one, Image):
            one.blob.close()


def _refusal(error: OperationalError | OSError) -> str | None:
    """Why the disk refuses, without paths; None if the error is another one."""
    if isinstance(error, OSError):
        return error.strerror if error.errno in _REFUSALS else None
    return str(error.orig) if disk_refuses(error) else None
