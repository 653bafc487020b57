"""Settings for every test."""

import os
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

# The same examples on every run, and no verdict by the clock: a slow machine is not a defect.
settings.register_profile("conicoid", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
# `make fuzz`: more examples, each of which must end.
settings.register_profile("fuzz", settings.get_profile("conicoid"), max_examples=5000, deadline=60_000)
settings.load_profile("conicoid")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--farm", action="store_true", help="the tests of jobs with a farm's servers and a worker")


@pytest.fixture(scope="session", autouse=True)
def own_state(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Services of tests keep their jobs where nobody else does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", os.fspath(tmp_path_factory.mktemp("state")))
        yield
