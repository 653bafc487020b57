"""The thread that works on the disk, and what it does about a caller who leaves."""

import asyncio
import errno
import logging
import os
import time
from collections.abc import Iterator
from pathlib import Path

import psycopg
import pytest
from sqlalchemy.exc import OperationalError

from conicoid_service.blob import Blob
from conicoid_service.errors import StorageError, StoreError
from conicoid_service.images import Image
from conicoid_service.jobs.storage import Storage
from conicoid_service.settings import Settings

pytestmark = pytest.mark.anyio


@pytest.fixture
def storage(tmp_path: Path) -> Iterator[Storage]:
    opened = Storage(Settings(data_dir=tmp_path))
    yield opened
    opened.close()


@pytest.mark.parametrize(
    "wrap", [lambda blob: blob, lambda blob: (Image(blob, "", 0, 0), "about it")], ids=["alone", "in an image"]
)
async def test_file_that_was_opened_for_who_has_left_is_closed(storage: Storage, wrap: object) -> None:
    blob = Blob()

    def slowly() -> object:
        time.sleep(0.3)
        return wrap(blob)  # type: ignore[operator]

    asking = asyncio.create_task(storage.do(slowly))
    await asyncio.sleep(0.1)
    asking.cancel()
    await asyncio.wait({asking})
    await storage.do(lambda: None)  # after it
    assert asking.cancelled()
    assert blob.file.closed


async def test_step_that_was_not_begun_is_not_taken_for_who_has_left(storage: Storage) -> None:
    taken: list[int] = []
    first = asyncio.create_task(storage.do(time.sleep, 0.3))
    await asyncio.sleep(0.1)
    second = asyncio.create_task(storage.do(taken.append, 1))
    await asyncio.sleep(0)
    second.cancel()
    await first
    await storage.do(lambda: None)
    assert taken == []


async def test_disk_that_refuses_is_told_from_a_defect(storage: Storage) -> None:
    def refuse(number: int) -> None:
        raise OSError(number, "No space left on device")

    with pytest.raises(StorageError, match="No space left on device") as refused:
        await storage.do(refuse, errno.ENOSPC)
    assert refused.value.retry_after_s
    assert storage.trouble == "No space left on device"
    with pytest.raises(OSError, match="No space"):
        await storage.do(refuse, errno.EBADF)
    await storage.do(storage.check)
    assert storage.trouble is None


async def test_what_a_database_server_says_is_for_the_log(storage: Storage, caplog: pytest.LogCaptureFixture) -> None:
    def refuse() -> None:
        said = 'connection to server at "10.0.0.7", port 5432 failed: FATAL: password of "conicoid"'
        raise OperationalError("SELECT 1", {}, psycopg.OperationalError(said))

    with caplog.at_level(logging.WARNING), pytest.raises(StorageError, match="the database does not answer") as refused:
        await storage.do(refuse)
    assert "10.0.0.7" not in f"{refused.value}{storage.trouble}"
    assert caplog.text.count("10.0.0.7") == 1


@pytest.mark.parametrize("again", ["touched", "written"])
def test_quadrics_that_a_new_job_asks_for_while_others_are_removed_stay(
    storage: Storage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, again: str
) -> None:
    with Blob.of(b"quadrics") as blob:
        for name in ("wanted", "others"):
            storage.quadrics.write(name, blob)
            os.utime(tmp_path / "quadrics" / name[:2] / name, (1, 1))
        names = storage.quadrics.names

        def meanwhile(older_than_ms: int) -> Iterator[str]:
            yield from sorted(names(older_than_ms))
            if again == "touched":
                storage.quadrics.touch("wanted")
            else:
                storage.quadrics.write("wanted", blob)

        monkeypatch.setattr(storage.quadrics, "names", meanwhile)
        storage.remove_quadrics(older_than_ms=2000)
    assert [storage.quadrics.size(name) for name in ("wanted", "others")] == [8, None]


def test_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="file/store: jobs cannot be kept here"):
        Storage(Settings(data_dir=tmp_path / "file" / "store"))
