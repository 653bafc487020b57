"""The servers that the farm's tests stand on: they keep what they are given, and leave nothing behind."""

import shutil
import subprocess
import sys
import time

import kombu
import obstore
import psycopg
import pytest
from obstore.store import S3Store

from tests.checkout import ROOT
from tests.farm.processes import lives, until
from tests.farm.servers import Broker, Database, Servers, Store, debians

QUORUM = {"x-queue-type": "quorum"}


def bucket(store: Store, url: str) -> S3Store:
    access = store.access()
    name, _, prefix = url.removeprefix("s3://").partition("/")
    return S3Store(
        name, prefix=prefix, endpoint=access["AWS_ENDPOINT_URL"], access_key_id=access["AWS_ACCESS_KEY_ID"],
        secret_access_key=access["AWS_SECRET_ACCESS_KEY"], region=access["AWS_REGION"],
        client_options={"allow_http": True},
    )  # fmt: skip


def put(url: str, body: str) -> None:
    """A message into the durable quorum queue `units`, told of by the broker once it has it."""
    with kombu.Connection(url, transport_options={"confirm_publish": True}) as connection:
        queue = kombu.Queue("units", queue_arguments=QUORUM)
        connection.Producer().publish(body, routing_key="units", declare=[queue])


def take(url: str) -> str | None:
    with kombu.Connection(url) as connection, connection.channel() as channel:
        message = kombu.Queue("units", queue_arguments=QUORUM).bind(channel).get()
        return None if message is None else str(message.decode())


@pytest.fixture(scope="module")
def broker(servers: Servers) -> Broker:
    return servers.broker


@pytest.fixture(scope="module")
def database(servers: Servers) -> Database:
    return servers.database


@pytest.fixture(scope="module")
def store(servers: Servers) -> Store:
    return servers.store


def test_broker_keeps_messages_when_it_is_killed(broker: Broker) -> None:
    url = broker.create()
    put(url, "kept")
    time.sleep(1.5)  # the names of new queues are on the disk half a second later, and one without a name is no more
    broker.restart()
    assert take(url) == "kept"


def test_broker_keeps_messages_when_it_is_stopped(broker: Broker) -> None:
    url = broker.create()
    put(url, "kept")
    broker.stop()
    broker.start()
    assert take(url) == "kept"


def test_broker_that_forgets_has_the_same_address_and_no_message(broker: Broker) -> None:
    url = broker.create("farm")
    put(url, "lost")
    broker.kill()
    broker.forget()
    broker.start()
    assert broker.create("farm") == url
    with kombu.Connection(url) as connection, connection.channel() as channel, pytest.raises(Exception, match="404"):
        kombu.Queue("units", queue_arguments=QUORUM).bind(channel).queue_declare(passive=True)


def test_database_keeps_rows_when_it_is_killed(database: Database) -> None:
    url = database.create()
    with psycopg.connect(url) as connection:
        connection.execute("CREATE TABLE frames (n integer)")
        connection.execute("INSERT INTO frames VALUES (7)")
    database.restart()
    with psycopg.connect(url) as connection:
        assert connection.execute("SELECT n FROM frames").fetchall() == [(7,)]


def test_database_that_is_stopped_does_not_wait_for_its_clients(database: Database) -> None:
    with psycopg.connect(database.url()) as connection:
        database.stop()
        database.start()
        with pytest.raises(psycopg.OperationalError):
            connection.execute("SELECT 1")


def test_store_keeps_objects_when_it_is_killed(store: Store) -> None:
    there = bucket(store, store.create())
    obstore.put(there, "images/ab/abcd", b"\0\1\2")
    store.restart()
    assert bytes(obstore.get(there, "images/ab/abcd").bytes()) == b"\0\1\2"
    assert [found["path"] for found in obstore.list(there).collect()] == ["images/ab/abcd"]


def test_each_farm_has_queues_tables_and_objects_of_its_own(servers: Servers) -> None:
    one, other = servers.environment(), servers.environment()
    put(one["CONICOID_BROKER_URL"], "one's")
    put(other["CONICOID_BROKER_URL"], "other's")
    assert take(one["CONICOID_BROKER_URL"]) == "one's"
    assert all(one[name] != other[name] for name in one if name.startswith("CONICOID_"))


def test_servers_listen_on_the_loopback_alone(servers: Servers) -> None:
    listening = subprocess.run(["ss", "-ltnpH"], capture_output=True, text=True, check=True).stdout.splitlines()
    for server in (servers.broker, servers.database, servers.store):
        pids = [server.process.pid, *server.process.children()]
        addresses = [line.split()[3] for line in listening for pid in pids if f"pid={pid}," in line]
        assert addresses
        assert {address.rpartition(":")[0] for address in addresses} == {"127.0.0.1"}


def test_program_that_is_missing_is_told_with_its_package() -> None:
    with pytest.raises(AssertionError, match="apt-get install --no-install-recommends rabbitmq-server"):
        debians("/usr/lib/nowhere/rabbitmq-server", "rabbitmq-server")


def test_servers_end_with_tests_that_are_killed() -> None:
    script = (
        "import sys, time; from tests.farm.servers import Servers\n"
        "with Servers() as servers:\n"
        "    for server in (servers.broker, servers.database, servers.store):\n"
        "        print(server.folder, server.process.pid, *server.process.children(), sep='\\n')\n"
        "    print('ready', flush=True); time.sleep(60)\n"
    )
    with subprocess.Popen([sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True) as tests:
        assert tests.stdout is not None
        lines = [*iter(tests.stdout.readline, "ready\n")]
        tests.kill()
    words = [line.strip() for line in lines]
    pids = [int(word) for word in words if word.isdigit()]
    assert len(pids) > 6
    until(lambda: not any(lives(pid) for pid in pids), "every server ended", 10)
    for folder in (word for word in words if not word.isdigit()):
        shutil.rmtree(folder)  # which nobody could do before
