"""Who of several API processes does what one must do alone."""

from collections.abc import Iterator

import psycopg
import pytest
from sqlalchemy import text
from sqlalchemy.exc import OperationalError

from conicoid_service.jobs.database import Database, alone
from conicoid_service.jobs.leadership import Leadership
from tests.farm.servers import Servers


@pytest.fixture
def two(servers: Servers) -> Iterator[tuple[Leadership, Leadership]]:
    url = servers.database.create()
    databases = Database(url), Database(url)
    yield Leadership(databases[0]), Leadership(databases[1])
    for database in databases:
        database.close()


def test_one_leads_until_it_resigns(two: tuple[Leadership, Leadership]) -> None:
    one, other = two
    assert [one.leads(), other.leads(), one.leads()] == [True, False, True]
    one.resign()
    assert [other.leads(), one.leads()] == [True, False]
    other.resign()


def test_what_is_done_alone_waits_for_the_same_and_for_no_other_lock(servers: Servers) -> None:
    url = servers.database.create()
    database = Database(url)
    with psycopg.connect(url) as leader, database.writing() as one, database.writing() as other:
        leader.execute("SELECT pg_advisory_lock(hashtext('jobs of me'))")  # whose key happens to be the same number
        for connection in (one, other):
            connection.execute(text("SET lock_timeout = '1s'"))
        alone(one, "jobs of me")
        alone(other, "jobs of another")
        with pytest.raises(OperationalError, match="lock timeout"):
            alone(other, "jobs of me")
    database.close()


def test_one_whose_session_ends_leads_no_more(servers: Servers, two: tuple[Leadership, Leadership]) -> None:
    one, other = two
    assert one.leads()
    with psycopg.connect(servers.database.url(), autocommit=True) as admin:
        admin.execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name = 'conicoid'")
    assert other.leads()
    with pytest.raises(Exception, match=r"terminat|closed"):
        one.leads()
    assert not one.leads()
    other.resign()
