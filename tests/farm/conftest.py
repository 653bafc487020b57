"""The servers of a farm, real ones, shared by all tests here; and how long a farm takes to recover, told in the end."""

import json
import os
from collections.abc import Iterator
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import pytest

from conicoid_bench.machine import commit, processor
from tests.farm.jobs import FRAMES, Recovery
from tests.farm.servers import Servers

_RECOVERIES: Final = pytest.StashKey[dict[str, Recovery]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--results", type=Path, metavar="DIR", help="write DIR/farm-recovery.json")


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_RECOVERIES] = {}


@pytest.fixture(scope="session")
def recoveries(pytestconfig: pytest.Config) -> dict[str, Recovery]:
    """By what happened."""
    return pytestconfig.stash[_RECOVERIES]


@pytest.fixture(scope="session")
def servers() -> Iterator[Servers]:
    """RabbitMQ, PostgreSQL and an S3-compatible server."""
    with Servers() as started:
        yield started


@pytest.fixture
def environment(servers: Servers) -> dict[str, str]:
    """What makes a service or a worker part of a farm of its own: nobody has used its queues, tables and bucket."""
    return servers.environment()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    recoveries = config.stash[_RECOVERIES]
    if not recoveries:
        return
    terminalreporter.section("seconds from a disturbance's end to the next frame, and to the job's end")
    for what, found in recoveries.items():
        terminalreporter.write_line(f"{found.next_frame_s:8.2f} {found.job_s:8.2f}  {what}")
    if folder := config.getoption("--results"):
        results = {
            "date": datetime.now(UTC).isoformat(timespec="seconds"), "commit": commit(), "processor": processor(),
            "cpus": os.cpu_count(), "frames": FRAMES,
            "seconds": {what: asdict(found) for what, found in recoveries.items()},
        }  # fmt: skip
        (folder / "farm-recovery.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")
