"""Everything of the job store that outlives a server, and the threads that work on it."""

import asyncio
import errno
import logging
import secrets
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final, ParamSpec, TypeVar

from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError

from conicoid_service.blob import Blob
from conicoid_service.errors import StorageError, StoreError
from conicoid_service.images import Image
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.database import Database, refuses
from conicoid_service.jobs.files import Files, files_at
from conicoid_service.jobs.folder import Folder
from conicoid_service.jobs.holder import Holder, Named
from conicoid_service.jobs.image_shelf import ImageShelf, sha256_of
from conicoid_service.jobs.leadership import Leadership
from conicoid_service.jobs.leases import Leases
from conicoid_service.jobs.mark import Mark
from conicoid_service.jobs.outbox import Outbox
from conicoid_service.jobs.scenes import Scenes
from conicoid_service.jobs.store import JobStore
from conicoid_service.jobs.upkeep import Upkeep
from conicoid_service.jobs.work import Work
from conicoid_service.settings import Settings

P = ParamSpec("P")
T = TypeVar("T")

RETRY_S: Final = 1.0
_THREADS: Final = 12  # a step of a farm's may wait for a network
_WORKERS_THREADS: Final = 2
_TABLES: Final = (JobStore, Work, Leases, Outbox, Upkeep, Scenes, Leadership)
_REFUSALS: Final = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO, errno.EMFILE}

logger = logging.getLogger(__name__)


class Storage:
    """The job store, opened: a data folder with a database and files in it, or a farm's database and object store.

    Its steps are made on threads: on one where it is a folder; else on some for the tables, and on others for what may
    wait for the object store.

    Args:
        settings: say where it is.
        api: whether this is an API, which makes tables and marks the object store as theirs; a worker has both made.

    Attributes:
        trouble: why what was last written was refused; None if it was taken.
    Raises:
        StoreError: it cannot be opened.
    """

    def __init__(self, settings: Settings, *, api: bool = True) -> None:
        lifetime_ms, place = round(settings.result_lifetime_s * 1e3), settings.object_store
        if settings.farm:
            self.images: Files = files_at(place, "images", "image/x-exr")
            self.quadrics: Files = files_at(place, "quadrics", "application/octet-stream")
            self.holder: Holder | Named = Named()
            self._mark: Mark | None
            threads = _THREADS if api else _WORKERS_THREADS
            self._database = Database(settings.database_url, migrate=api, patient=not api, threads=2 * threads)
            self._for_tables = ThreadPoolExecutor(threads, thread_name_prefix="job-tables")
            self._for_files = ThreadPoolExecutor(threads, thread_name_prefix="job-files")
            self._mark = Mark(files_at(place, "mark", "text/plain"), self._database, sets=api)
        else:
            self.images, self.quadrics, self.holder = _folders(settings.data_dir)
            try:
                self._database = Database(settings.data_dir / "jobs.sqlite")
            except StoreError:
                self.holder.close()
                raise
            self._for_tables = self._for_files = ThreadPoolExecutor(1, thread_name_prefix="job-store")
            self._mark = None
        self.jobs = JobStore(self._database, lifetime_ms, settings.owner_frame_limit, settings.band_pixels)
        self.work = Work(self._database, self.holder.name, lifetime_ms)
        self.upkeep = Upkeep(self._database)
        self.outbox = Outbox(self._database, lifetime_ms)
        self.leases = Leases(self._database, self.work, self.outbox)
        self.scenes = Scenes(self._database, settings.kept_limit)
        self.leadership = Leadership(self._database)
        self.shelf = ImageShelf(self.images, self.upkeep)
        self.trouble: str | None = None
        self.shared, self.now_ms = self._database.shared, self._database.now_ms

    @property
    def full(self) -> bool:
        """Whether the disk needs room; a server that is away needs none."""
        return self.trouble is not None and isinstance(self.holder, Holder)

    async def do(self, step: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Have a thread take a step.

        Raises:
            StorageError: the disk or a server refuses; the same step may succeed later.
        """
        # What only reads and writes tables never waits behind what waits for files.
        tables = isinstance(getattr(step, "__self__", None), _TABLES)
        working = (self._for_tables if tables else self._for_files).submit(step, *args, **kwargs)
        try:
            return await asyncio.wrap_future(working)
        except asyncio.CancelledError:
            working.add_done_callback(_close_files)  # nobody will
            raise
        except (DBAPIError, PoolTimeoutError, OSError) as error:
            self.trouble = _refusal(error)
            if self.trouble is None:
                raise
            what = "the job store" if self.shared else "the disk"
            raise StorageError(f"{what} does not take it ({self.trouble}); try again later") from error

    async def insist(self, step: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Have a thread take a step, however long it is refused."""
        while True:
            try:
                return await self.do(step, *args, **kwargs)
            except StorageError as error:
                logger.warning("%s", error)
                await asyncio.sleep(RETRY_S)

    async def image(self, tag: str) -> Image | None:
        """The image that an entity tag names, which the caller closes.

        None, and forgotten, if it is missing or not as it was written.

        Raises:
            StorageError: as in `do`.
        """
        if self.shared:
            await self.do(self.check_mark)
        found = await self.do(self.shelf.get, tag, now_ms())
        if found is None:
            return None
        image, known = found
        if await asyncio.to_thread(sha256_of, image.blob) == known.sha256:
            return image
        image.blob.close()
        await self.do(self.shelf.forget, known)
        return None

    def check(self) -> None:
        """Write and remove a small file, in a store that is the database's.

        Raises:
            OSError: it is not taken.
        """
        name = f"check-{secrets.token_hex(8)}"
        with Blob.of(b"conicoid\n") as blob:
            self.images.write(name, blob)
        self.images.remove(name)
        self.check_mark()
        self.trouble = None

    def check_mark(self) -> None:
        """See that the files are those of the database, and not of another, or of a mount point without its mount.

        Raises:
            OSError: they are not, or cannot be had.
        """
        if not self.is_marked():
            raise OSError(errno.EIO, "the object store is not the one of this database")

    def is_marked(self) -> bool:
        """Whether the files are those of the database.

        Raises:
            OSError: that cannot be found out.
        """
        return self._mark is None or self._mark.is_set()

    def remove_quadrics(self, older_than_ms: int) -> None:
        """Remove the quadrics that no job needs, nor one that is about to be made: it has touched them by now."""
        needed = self.upkeep.needed_quadrics()
        for name in list(self.quadrics.names(older_than_ms)):
            if name not in needed and self.quadrics.is_older(name, older_than_ms):
                self.quadrics.remove(name)

    def close(self) -> None:
        """End the threads and give everything up."""
        for threads in (self._for_tables, self._for_files):
            threads.shutdown()
        self.leadership.resign()
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


def _folders(root: Path) -> tuple[Folder, Folder, Holder]:
    try:
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        return Folder(root / "images"), Folder(root / "quadrics"), Holder(root / "holders")
    except OSError as error:
        raise StoreError(
            f"{root}: jobs cannot be kept here ({error.strerror}); give a folder that can be written to as `data_dir`"
        ) from None


def _refusal(error: DBAPIError | PoolTimeoutError | OSError) -> str | None:
    """Why something is refused, without paths and hosts; None if the error is another one."""
    if isinstance(error, PoolTimeoutError):
        return "too much is asked of the database"
    if isinstance(error, OSError):
        return error.strerror if error.errno in _REFUSALS else None
    if not refuses(error):
        return None
    reason = " ".join(str(error.orig).split())
    if not hasattr(error.orig, "sqlstate"):  # SQLite's, a few words
        return reason
    logger.warning("the database: %s", reason)
    return "the database does not answer"
