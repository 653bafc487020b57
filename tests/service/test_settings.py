"""Settings come from the environment, are checked when they are read, and are all documented."""

import re
from dataclasses import fields
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from sqlalchemy import make_url

from conicoid_service.access.keys import Keys
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
        "CONICOID_RENDER_MEMORY_LIMIT": "13",
        "CONICOID_RENDER_RECYCLE_AFTER": "14",
        "CONICOID_OWNER_QUEUE_LENGTH": "15",
        "CONICOID_DATA_DIR": "/var/lib/x",
        "CONICOID_STORE_LIMIT": "9",
        "CONICOID_RESULT_LIFETIME_S": "3.5",
        "CONICOID_FRAME_LIMIT": "10",
        "CONICOID_JOB_PIXEL_LIMIT": "11",
        "CONICOID_OWNER_FRAME_LIMIT": "12",
        "CONICOID_API_KEYS": "farm=secret",
        "CONICOID_OWNER_REQUESTS": "6",
        "CONICOID_CORS_ORIGINS": "https://a.example, http://localhost:5173",
        "CONICOID_CONNECTION_LIMIT": "8",
        "CONICOID_HEAD_TIMEOUT_S": "3.5",
        "CONICOID_BODY_TIMEOUT_S": "4.5",
        "CONICOID_SEND_TIMEOUT_S": "5.5",
        "CONICOID_LOG_FORMAT": "json",
        "CONICOID_DATABASE_URL": "postgresql://a:b@host/c",
        "CONICOID_BROKER_URL": "amqp://a:b@host/c",
        "CONICOID_OBJECT_STORE": "s3://bucket/prefix",
        "CONICOID_DOWNLOAD_REDIRECT_S": "6.5",
        "CONICOID_BAND_PIXELS": "16",
        "CONICOID_WORKER_PORT": "17",
    }
    assert values.keys() == {variable(one.name) for one in fields(Settings)}
    assert Settings.from_environment(values) == Settings(
        1000, 2, 3, 4, 5, 0, 1.5, 2.5, "PoCL 3.1", 7, Path("/var/cache/x"),
        render_processes=8,
        render_memory_limit=13,
        render_recycle_after=14,
        owner_queue_length=15,
        data_dir=Path("/var/lib/x"),
        store_limit=9,
        result_lifetime_s=3.5,
        frame_limit=10,
        job_pixel_limit=11,
        owner_frame_limit=12,
        api_keys=Keys.parse("farm=secret"),
        owner_requests=6,
        cors_origins=("https://a.example", "http://localhost:5173"),
        connection_limit=8,
        head_timeout_s=3.5,
        body_timeout_s=4.5,
        send_timeout_s=5.5,
        log_format="json",
        database_url="postgresql://a:b@host/c",
        broker_url="amqp://a:b@host/c",
        object_store="s3://bucket/prefix",
        download_redirect_s=6.5,
        band_pixels=16,
        worker_port=17,
    )  # fmt: skip


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


@pytest.mark.parametrize(
    ("name", "text", "rule"),
    [
        ("BROKER_URL", "redis://:secret@host", "is no URL of a RabbitMQ server; write one like amqp://"),
        ("DATABASE_URL", "mysql://a:secret@host/b", "is no URL of a PostgreSQL database; write one like postgresql://"),
        ("DATABASE_URL", "postgresql:a", "is no URL of a PostgreSQL database"),
        ("OBJECT_STORE", "/mnt/share", "is no URL of an object store; write one like s3://bucket/prefix or file:///"),
        ("OBJECT_STORE", "s3:///prefix", "is no URL of an object store"),
        ("DATABASE_URL", "postgresql://a:pass@secret@host/b", "more than one @.* in percent-encoding: %40 for @"),
        ("DATABASE_URL", "postgresql://a:1/2@secret@host/b", "more than one @"),
        ("DATABASE_URL", "postgresql://a:1?secret@host/b", "more than one @"),
        ("DATABASE_URL", "postgresql://a:1#secret@host/b", "more than one @, or a #"),
        ("DATABASE_URL", "postgresql://a:secret/1@host/b", "@"),
        ("DATABASE_URL", "postgresql://a:b@host:secret/b", "port that is no number from 0 to 65535"),
        ("DATABASE_URL", "postgresql://a:b@host:65536/b", "port that is no number"),
        ("DATABASE_URL", "postgresql://a:[secret]@host/b", "is no URL of a PostgreSQL database"),
        ("DATABASE_URL", "postgresql://a:secret\u2100@host/b", "is no URL of a PostgreSQL database"),
        ("BROKER_URL", "amqp://a:pass@secret@host/b", "more than one @"),
        ("BROKER_URL", "amqp://a:b@host:secret/b", "port that is no number"),
    ],
)
def test_a_place_that_no_farm_can_have_is_refused_without_its_password(name: str, text: str, rule: str) -> None:
    with pytest.raises(SettingsError, match=rf"CONICOID_{name}: .*{rule}") as refused:
        Settings.from_environment({f"CONICOID_{name}": text})
    assert "secret" not in str(refused.value)


@pytest.mark.parametrize(
    "text",
    [
        "postgresql://a:%40%23%2F%3A%3F%25@host:5432/b?sslmode=require",
        "postgresql://a:b:c@[::1]:5432/d",
        "postgresql://host/b",
    ],
)
def test_database_that_is_let_through_is_the_one_that_is_opened(text: str) -> None:
    others = {"CONICOID_BROKER_URL": "amqp://host", "CONICOID_OBJECT_STORE": "file:///a@b"}
    url = make_url(Settings.from_environment({"CONICOID_DATABASE_URL": text, **others}).database_url)
    parts = urlsplit(text)
    password = unquote(parts.password) if parts.password else None
    assert (url.username, url.password, url.host, url.port) == (parts.username, password, parts.hostname, parts.port)


def test_half_a_farm_is_refused() -> None:
    with pytest.raises(SettingsError, match="CONICOID_DATABASE_URL, CONICOID_OBJECT_STORE: not set, and a farm needs"):
        Settings.from_environment({"CONICOID_BROKER_URL": "amqp://host"})


def test_other_variables_are_not_looked_at() -> None:
    assert Settings.from_environment({"CONICOID_RENDER_COMMAND": "/bin/sh", "BODY_LIMIT": "1"}) == Settings()


def test_every_setting_is_documented_with_its_default() -> None:
    rows = re.findall(
        r"^\| `(CONICOID_[A-Z_]+)` \| `?([^`|]*)`? \|", (ROOT / "docs/http.md").read_text("utf-8"), re.MULTILINE
    )
    documented = {name: default.strip().replace(",", "") for name, default in rows}
    expected = {variable(one.name): written(getattr(Settings(), one.name)) for one in fields(Settings)}
    expected["CONICOID_CACHE_DIR"] = "~/.cache/conicoid"
    expected["CONICOID_DATA_DIR"] = "~/.local/state/conicoid"
    expected["CONICOID_RESULT_LIFETIME_S"] = "604800"
    expected["CONICOID_DEVICE"] = "any"
    assert documented == expected


def written(default: object) -> str:
    return f"{default:g}" if isinstance(default, float) else str(default) if default not in ((), Keys()) else "none"


def file_of(folder: Path, text: str) -> str:
    (folder / "conicoid.toml").write_text(text, "utf-8")
    return str(folder / "conicoid.toml")


def test_a_file_sets_what_the_environment_does_not(tmp_path: Path) -> None:
    file = file_of(tmp_path, 'quadric_limit = 2\ndeadline_s = 5\ndevice = "PoCL"\npixel_limit = 3\ncache_dir = "/x"\n')
    expected = Settings(quadric_limit=2, deadline_s=5.0, device="PoCL", pixel_limit=4, cache_dir=Path("/x"))
    assert Settings.from_environment({"CONICOID_CONFIG": file, "CONICOID_PIXEL_LIMIT": "4"}) == expected
    assert Settings.from_environment({"CONICOID_CONFIG": "/nowhere", "CONICOID_PIXEL_LIMIT": "4"}, file) == expected


@pytest.mark.parametrize("value", ['"a=key1 key2"', '["a=key1", "key2"]'])
def test_lists_are_written_as_one_string_or_several(tmp_path: Path, value: str) -> None:
    settings = Settings.from_environment({}, file_of(tmp_path, f"api_keys = {value}"))
    assert settings.api_keys == Keys.parse("a=key1,key2")


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("quadric_limits = 1", "quadric_limits is no setting; the settings are .*quadric_limit"),
        ("[service]\nquadric_limit = 1", "service is no setting"),
        ("quadric_limit = 1.5", "quadric_limit: 1.5 is not a whole number; write a whole number"),
        ('quadric_limit = "1"', "quadric_limit: '1' is not a whole number"),
        ("quadric_limit = true", "quadric_limit: True is not a whole number"),
        ("quadric_limit = 0", "quadric_limit: '0' is not a finite number >= 1"),
        ("deadline_s = false", "deadline_s: False is not a number"),
        ("deadline_s = nan", "deadline_s: 'nan' is not a finite number >= 0.001"),
        ("deadline_s = 1e999", "deadline_s: 'inf' is not a finite number"),
        ("device = 3", "device: 3 is not a string"),
        ("device = ['a', 'b']", "device: .* is not a string"),
        ("cors_origins = [1]", r"cors_origins: \[1\] is not a string or a list of strings"),
        ("cors_origins = 'example.org'", "cors_origins: 'example.org' is no origin; write one like"),
        ("quadric_limit = 1\nquadric_limit = 2", "is not TOML"),
        ("quadric_limit =", "is not TOML"),
        (f"quadric_limit = {'9' * 5000}", "is not TOML"),
    ],
)
def test_a_file_that_cannot_be_is_refused_by_file_and_key(tmp_path: Path, text: str, rule: str) -> None:
    file = file_of(tmp_path, text)
    with pytest.raises(SettingsError, match=rf"^{re.escape(file)}: {rule}"):
        Settings.from_environment({}, file)


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "latin").write_bytes(b'device = "\xe9"')
    for path, rule in (
        (tmp_path / "nothing", "no such file"),
        (tmp_path, "is a directory"),
        (tmp_path / "latin", "UTF-8"),
    ):
        with pytest.raises(SettingsError, match=rf"^{re.escape(str(path))}: .*{rule}"):
            Settings.from_environment({"CONICOID_CONFIG": str(path)})


@pytest.mark.parametrize(
    "text", ["farm=secret\x01", "sha256:secret", "secret, secret", "secret=", "a=secret b=secret", " , "]
)
def test_no_key_is_ever_repeated(tmp_path: Path, text: str) -> None:
    written_file = file_of(tmp_path, f"api_keys = {text!r}".replace("\\x01", "\\u0001").replace("'", '"'))
    for environment, file in (({"CONICOID_API_KEYS": text}, None), ({}, written_file)):
        with pytest.raises(SettingsError, match=r"api_keys|CONICOID_API_KEYS") as refused:
            Settings.from_environment(environment, file)
        assert "secret" not in str(refused.value)
    with pytest.raises(SettingsError, match="api_keys: the value is not") as refused:
        Settings.from_environment({}, file_of(tmp_path, 'api_keys = {secret = "secret"}'))
    assert "secret" not in str(refused.value)
    assert "secret" not in repr(Settings(api_keys=Keys.parse("farm=secret")))
