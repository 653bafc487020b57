"""The servers of a farm, real ones, shared by all tests here."""

from collections.abc import Iterator

import pytest

from tests.farm.servers import Servers


@pytest.fixture(scope="session")
def servers() -> Iterator[Servers]:
    """RabbitMQ, PostgreSQL and an S3-compatible server."""
    with Servers() as started:
        yield started


@pytest.fixture
def environment(servers: Servers) -> dict[str, str]:
    """What makes a service or a worker part of a farm of its own: nobody has used its queues, tables and bucket."""
    return servers.environment()
