"""Leases by the database's clock, and the mark that says which object store is the database's."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from conicoid_service.errors import StoreError
from conicoid_service.jobs.clock import now_ms
from conicoid_service.jobs.leases import OVERTAKEN_MS, SILENCE_MS, UNHEARD_MS
from conicoid_service.jobs.records import PRIORITIES
from conicoid_service.jobs.storage import Storage
from conicoid_service.settings import Settings
from tests.farm.servers import Servers
from tests.service.jobs.stores import new_job

NORMAL = PRIORITIES["normal"]


def settings_of(servers: Servers, folder: Path) -> Settings:
    folder.mkdir(exist_ok=True)
    return Settings(
        database_url=servers.database.create(), broker_url="amqp://nobody", object_store=(folder / "objects").as_uri()
    )


@pytest.fixture
def settings(servers: Servers, tmp_path: Path) -> Settings:
    made = settings_of(servers, tmp_path)
    (tmp_path / "objects").mkdir()
    return made


@pytest.fixture
def api(settings: Settings) -> Iterator[Storage]:
    storage = Storage(settings)
    yield storage
    storage.close()


@pytest.mark.parametrize("skew_ms", [-25_000, 25_000])
def test_worker_whose_clock_is_wrong_keeps_its_unit(
    settings: Settings, api: Storage, monkeypatch: pytest.MonkeyPatch, skew_ms: int
) -> None:
    api.jobs.create(new_job(1), 0)
    (unit,) = api.leases.send(NORMAL, 1)
    with monkeypatch.context() as patch:
        patch.setattr("conicoid_service.jobs.database.now_ms", lambda: now_ms() + skew_ms)
        worker = Storage(settings, api=False)
        assert abs(worker.now_ms() - now_ms()) < 1000
        assert worker.leases.take(unit, redelivered=False) is not None
        worker.close()
    assert api.leases.recall_silent() == 0
    assert api.leases.take(unit, redelivered=False) is None
    again = api.leases.take(unit, redelivered=True)
    assert again is not None
    assert again.attempts == 2


def test_unit_that_was_overtaken_is_lost_though_the_queue_is_never_empty(api: Storage) -> None:
    assert OVERTAKEN_MS > SILENCE_MS > UNHEARD_MS
    api.jobs.create(new_job(2), 0)
    now = api.now_ms()
    (lost,) = api.outbox.take(NORMAL, 1, now - OVERTAKEN_MS - 1)
    (later,) = api.outbox.take(NORMAL, 1, now)
    assert api.leases.recall_lost(NORMAL, queue_is_empty=False) == 0
    assert api.leases.take(later, redelivered=False)
    assert api.leases.recall_lost(NORMAL, queue_is_empty=False) == 1
    assert api.leases.send(NORMAL, 2) == [lost]


def test_unit_is_not_lost_at_once_when_the_queue_is_empty(api: Storage) -> None:
    api.jobs.create(new_job(2), 0)
    api.outbox.take(NORMAL, 1, api.now_ms() - UNHEARD_MS - 1000)
    api.leases.send(NORMAL, 1)
    assert api.leases.recall_lost(NORMAL, queue_is_empty=True) == 1


def test_store_of_another_database_is_told_from_its_own(servers: Servers, settings: Settings, tmp_path: Path) -> None:
    api = Storage(settings)
    assert api.is_marked()
    worker = Storage(settings, api=False)
    assert worker.is_marked()
    worker.close()
    elsewhere = tmp_path / "elsewhere"
    (elsewhere / "objects").mkdir(parents=True)
    other = Settings(
        database_url=settings.database_url, broker_url="amqp://nobody", object_store=(elsewhere / "objects").as_uri()
    )
    for is_api in (False, True):  # an API marks a store once, not every store that it is led to
        wrong = Storage(other, api=is_api)
        assert not wrong.is_marked()
        with pytest.raises(OSError, match="not the one of this database"):
            wrong.check_mark()
        wrong.close()
    api.close()
    assert servers


def test_directory_that_is_not_mounted_is_not_made(servers: Servers, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="files cannot be kept here"):
        Storage(settings_of(servers, tmp_path / "none"))
    assert not (tmp_path / "none" / "objects").exists()
