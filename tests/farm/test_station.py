"""What a worker does with a message, whatever the broker."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from conicoid_service.farm.queues import message_of
from conicoid_service.farm.station import Station
from conicoid_service.jobs.records import PRIORITIES, Unit
from conicoid_service.jobs.storage import Storage
from conicoid_service.settings import Settings
from tests.checkout import ROOT
from tests.farm.servers import Servers
from tests.service.conftest import FAKE
from tests.service.jobs.stores import new_job

NORMAL = PRIORITIES["normal"]


@pytest.fixture
def settings(servers: Servers, tmp_path: Path) -> Settings:
    return Settings(database_url=servers.database.create(), broker_url="amqp://nobody", object_store=tmp_path.as_uri())


@pytest.fixture
def api(settings: Settings) -> Iterator[Storage]:
    storage = Storage(settings)
    assert storage.is_marked()
    yield storage
    storage.close()


@pytest.fixture(autouse=True)
def search_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets the fake render process find the tests."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


@pytest.fixture
def station(settings: Settings) -> Iterator[Station]:
    made = Station(settings, FAKE)
    yield made
    made.close()


def sent(api: Storage) -> Unit:
    """A unit whose quadrics are nowhere."""
    api.jobs.create(new_job(1), 0)
    (unit,) = api.leases.send(NORMAL, 1)
    return unit


def test_unit_that_cannot_be_rendered_fails_with_the_cause_and_is_done(api: Storage, station: Station) -> None:
    unit = sent(api)
    assert station.execute(message_of(unit), redelivered=False) == "done"
    (frame,) = api.jobs.frames(unit.job_id, 0, 9)
    assert frame.state == "failed"
    assert "submit it again" in (frame.error_detail or "")
    assert station.execute(message_of(unit), redelivered=True) == "dropped"


def test_unit_of_another_engine_is_given_back_unbegun(api: Storage, station: Station) -> None:
    unit = sent(api)
    assert station.execute({**message_of(unit), "engine": "conicoid 0.0.1"}, redelivered=False) == "unable"
    assert api.leases.send(NORMAL, 9) == [unit]
    assert api.work.frame(unit.job_id, 0).attempts == 0


def test_unit_whose_store_is_elsewhere_is_given_back_unbegun(
    api: Storage, settings: Settings, tmp_path_factory: pytest.TempPathFactory
) -> None:
    unit = sent(api)
    elsewhere = replace(settings, object_store=tmp_path_factory.mktemp("unmounted").as_uri())
    station = Station(elsewhere, FAKE)
    try:
        assert station.execute(message_of(unit), redelivered=False) == "unable"
    finally:
        station.close()
    assert api.leases.send(NORMAL, 9) == [unit]
