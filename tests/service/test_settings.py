"""Settings come from the environment, are checked when they are read, and are all documented."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from conicoid_service.errors import SettingsError
from conicoid_service.settings import Settings, variable
from tests.checkout import ROOT


def test_an_empty_environment_gives_the_defaults() -> None:
    assert Settings.from_environment({}) == Settings.from_environment({"CONICOID_THREADS": ""}) == Settings()


def test_the_contracts_limits_are_the_defaults() -> None:
    settings = Settings()
    assert settings.body_limit == 256 * 1024 * 1024
    assert settings.quadric_limit == 2_000_000
    assert settings.pixel_limit == 67_000_000


def test_every_setting_is_read_from_its_variable() -> None:
    values = {
        "CONICOID_BODY_LIMIT": "1000",
        "CONICOID_QUADRIC_LIMIT": "2",
        "CONICOID_PIXEL_LIMIT": "3",
        "CONICOID_KEPT_LIMIT": "4",
        "CONICOID_IMAGE_CACHE_LIMIT": "5",
        "CONICOID_QUEUE_LENGTH": "0",
        "CONICOID_DEADLINE_S": "1.5",
        "CONICOID_START_DEADLINE_S": "2.5",
        "CONICOID_DEVICE": "PoCL 3.1",
        "CONICOID_THREADS": "7",
        "CONICOID_CACHE_DIR": "/var/cache/x",
        "CONICOID_RENDER_PROCESSES": "8",
        "CONICOID_DATA_DIR": "/var/lib/x",
        "CONICOID_STORE_LIMIT": "9",
        "CONICOID_RESULT_LIFETIME_S": "3.5",
        "CONICOID_FRAME_LIMIT": "10",
        "CONICOID_JOB_PIXEL_LIMIT": "11",
        "CONICOID_OWNER_FRAME_LIMIT": "12",
    }
    assert values.keys() == {variable(one.name) for one in fields(Settings)}
    assert Settings.from_environment(values) == Settings(
        1000, 2, 3, 4, 5, 0, 1.5, 2.5, "PoCL 3.1", 7, Path("/var/cache/x"), 8, Path("/var/lib/x"), 9, 3.5, 10, 11, 12
    )


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("BODY_LIMIT", "256 MiB"),
        ("BODY_LIMIT", "0"),
        ("QUADRIC_LIMIT", "1.5"),
        ("PIXEL_LIMIT", "-1"),
        ("QUEUE_LENGTH", "-1"),
        ("DEADLINE_S", "0"),
        ("DEADLINE_S", "nan"),
        ("DEADLINE_S", "inf"),
        ("THREADS", "two"),
    ],
)
def test_a_value_that_cannot_be_is_refused_by_its_variables_name(name: str, text: str) -> None:
    with pytest.raises(SettingsError, match=rf"CONICOID_{name}: '{re.escape(text)}' is not"):
        Settings.from_environment({f"CONICOID_{name}": text})


def test_other_variables_are_not_looked_at() -> None:
    assert Settings.from_environment({"CONICOID_RENDER_COMMAND": "/bin/sh", "BODY_LIMIT": "1"}) == Settings()


def test_every_setting_is_documented_with_its_default() -> None:
    rows = re.findall(
        r"^\| `(CONICOID_[A-Z_]+)` \| `?([^`|]*)`? \|", (ROOT / "docs/http.md").read_text("utf-8"), re.MULTILINE
    )
    documented = {name: default.strip().replace(",", "") for name, default in rows}
    expected = {variable(one.name): str(getattr(Settings(), one.name)) for one in fields(Settings)}
    expected["CONICOID_CACHE_DIR"] = "~/.cache/conicoid"
    expected["CONICOID_DATA_DIR"] = "~/.local/state/conicoid"
    expected["CONICOID_RESULT_LIFETIME_S"] = "604800"
    expected["CONICOID_DEVICE"] = "any"
    expected["CONICOID_DEADLINE_S"] = "60"
    expected["CONICOID_START_DEADLINE_S"] = "120"
    assert documented == expected
