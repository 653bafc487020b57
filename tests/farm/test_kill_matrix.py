"""A batch on a farm of three workers while its parts end, go away and come back: every frame arrives, once and right.

The time from the end of each disturbance to the next frame, and to the job's end, is printed in the end; with
`--results DIR` it is written there too.
"""

import os
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

import pytest

from tests.farm.farm import Farm
from tests.farm.jobs import FRAMES, Job, Recovery, batch, order_of_ends
from tests.farm.network import Network
from tests.farm.proxy import Proxy
from tests.farm.servers import Servers
from tests.running import Service

AWAY_S = 3.0  # for which what can come back does not
Rows = dict[str, Recovery]


class Check(Protocol):
    """Disturbs a job on a farm when some frames have ended, and checks what comes out of it."""

    def __call__(
        self, farm: Farm, environment: Mapping[str, str], disturb: Callable[[], None], after: int = 15
    ) -> None: ...


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What the frames are on one machine, without a farm."""
    folder = tmp_path_factory.mktemp("single")
    with Service(folder / "store", folder / "log") as service, Job(service.url, batch()) as job:
        job.wait_for(FRAMES)
        return job.digests()


@pytest.fixture
def check(undisturbed: list[str], recoveries: Rows, request: pytest.FixtureRequest) -> Check:
    def checked(farm: Farm, environment: Mapping[str, str], disturb: Callable[[], None], after: int = 15) -> None:
        with Job(farm.api.url, batch()) as job:
            recovery = job.recovery(disturb, after)
            assert job.now()["state"] == "succeeded", job.now()
            ends = order_of_ends(environment["CONICOID_DATABASE_URL"], job.id)
            assert sorted(filter(None, ends)) == list(range(1, FRAMES + 1))
            assert sorted(job.told()) == list(range(FRAMES))
            assert job.digests() == undisturbed
        recoveries[request.node.name.removeprefix("test_").replace("_", " ")] = recovery

    return checked


@pytest.fixture
def farm(tmp_path: Path, environment: dict[str, str]) -> Iterator[Farm]:
    with Farm(tmp_path, environment) as farm:
        yield farm


def test_nothing_happens(check: Check, farm: Farm, environment: dict[str, str]) -> None:
    check(farm, environment, lambda: None)


def test_child_of_a_worker_is_killed(check: Check, farm: Farm, environment: dict[str, str]) -> None:
    check(farm, environment, lambda: os.kill(farm.workers[0].pool_child(), signal.SIGKILL))


def test_worker_is_killed(check: Check, farm: Farm, environment: dict[str, str]) -> None:
    check(farm, environment, farm.workers[0].kill)


def test_all_workers_are_killed_and_started_again(check: Check, farm: Farm, environment: dict[str, str]) -> None:
    def disturb() -> None:
        for worker in farm.workers:
            worker.kill()
        for worker in farm.workers:
            worker.begin()
        for worker in farm.workers:
            worker.wait()

    check(farm, environment, disturb)


def test_worker_is_told_to_stop(check: Check, farm: Farm, environment: dict[str, str]) -> None:
    check(farm, environment, lambda: _same(farm.workers[0].stop(), 0))


def test_api_is_killed_and_started_again(check: Check, farm: Farm, environment: dict[str, str]) -> None:
    def disturb() -> None:
        farm.api.kill()
        farm.api.start()

    check(farm, environment, disturb, after=0)  # what is with the broker goes on meanwhile, and may be all


def test_broker_is_killed_and_started_again(
    check: Check, farm: Farm, environment: dict[str, str], servers: Servers
) -> None:
    check(farm, environment, servers.broker.restart)


def test_broker_loses_its_data(check: Check, farm: Farm, environment: dict[str, str], servers: Servers) -> None:
    def disturb() -> None:
        servers.broker.kill()
        servers.broker.forget()
        servers.broker.start()
        servers.broker.create(environment["CONICOID_BROKER_URL"].rpartition("/")[2])

    check(farm, environment, disturb)


def test_database_is_killed_and_started_again(
    check: Check, farm: Farm, environment: dict[str, str], servers: Servers
) -> None:
    def disturb() -> None:
        servers.database.kill()
        time.sleep(AWAY_S)
        servers.database.start()

    check(farm, environment, disturb)


@contextmanager
def behind_a_proxy(folder: Path, environment: Mapping[str, str], servers: Servers) -> Iterator[tuple[Farm, Proxy]]:
    """A farm that reaches its object store through a proxy."""
    store = servers.store
    with Proxy(store.port) as proxy:
        access = store.access(f"http://127.0.0.1:{proxy.port}")
        with Farm(folder, {**environment, **access}) as farm:
            yield farm, proxy


def test_object_store_answers_with_errors(
    check: Check, tmp_path: Path, environment: dict[str, str], servers: Servers
) -> None:
    with behind_a_proxy(tmp_path, environment, servers) as (farm, proxy):

        def disturb() -> None:
            proxy.answer(503)
            time.sleep(AWAY_S)
            proxy.let_through()

        check(farm, environment, disturb)


def test_object_store_stands_still(check: Check, tmp_path: Path, environment: dict[str, str], servers: Servers) -> None:
    with behind_a_proxy(tmp_path, environment, servers) as (farm, proxy):

        def disturb() -> None:
            proxy.stall()
            time.sleep(AWAY_S)
            proxy.let_through()

        check(farm, environment, disturb)


def test_object_store_is_away(check: Check, tmp_path: Path, environment: dict[str, str], servers: Servers) -> None:
    with behind_a_proxy(tmp_path, environment, servers) as (farm, proxy):

        def disturb() -> None:
            proxy.refuse()
            time.sleep(AWAY_S)
            proxy.let_through()

        check(farm, environment, disturb)


def test_network_of_one_worker_is_cut_for_a_while(check: Check, tmp_path: Path) -> None:
    with Network() as network, Servers(network.address) as servers:
        environment = servers.environment()

        def disturb() -> None:
            network.pull()
            time.sleep(AWAY_S)
            network.plug()

        with Farm(tmp_path, environment, networks=[network]) as farm:
            check(farm, environment, disturb)


def test_network_of_one_worker_is_cut_for_longer_than_the_job(check: Check, tmp_path: Path) -> None:
    with Network() as network, Servers(network.address) as servers:
        environment = servers.environment()
        with Farm(tmp_path, environment, networks=[network]) as farm:
            check(farm, environment, network.pull)
            network.plug()
            for worker in farm.workers[:2]:
                assert worker.stop() == 0
            with Job(farm.api.url, batch(near=0.2)) as job:  # for the worker that is back
                job.wait_for(FRAMES)
                assert job.now()["state"] == "succeeded"


def _same(found: int, wanted: int) -> None:
    assert found == wanted
