"""Who of several API processes does what one must do alone."""

from collections.abc import Iterator

import psycopg
import pytest

from conicoid_service.jobs.database import Database
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
