"""Settings as they are written: in a TOML file, in an environment variable."""

import re
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final
from urllib.parse import SplitResult, urlsplit

from conicoid_service.errors import SettingsError
from conicoid_service.telemetry.logs import FORMATS

_RULES: Final[Mapping[Any, str]] = {int: "a whole number", float: "a number"}
_TOML_TYPES: Final[Mapping[Any, tuple[type, ...]]] = {int: (int,), float: (int, float)}
_LONGEST_SHOWN: Final = 80


def read_file(path: str) -> dict[str, Any]:
    """The keys of a TOML file.

    Raises:
        SettingsError: it cannot be read, or is not TOML.
    """
    try:
        return tomllib.loads(Path(path).read_bytes().decode())
    except OSError as error:
        raise SettingsError(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}; name another") from None
    except ValueError as error:
        raise SettingsError(f"{path}: is not TOML in UTF-8: {error}; see docs/http.md") from None


def text_of(place: str, value: Any, kind: Callable[[str], Any], secret: bool) -> str:
    """A file's value as an environment variable would have it.

    Raises:
        SettingsError: it has not the type that TOML has for it.
    """
    if kind is parse_origins or secret:
        value = [value] if type(value) is str else value
        if type(value) is list and all(type(word) is str for word in value):
            return " ".join(value)
        rule = "a string or a list of strings"
    else:
        if type(value) in _TOML_TYPES.get(kind, (str,)):
            return str(value)
        rule = _RULES.get(kind, "a string")
    raise SettingsError(f"{place}: {'the value' if secret else _shown(value)} is not {rule}; write {rule}")


def value_of(
    place: str, text: str, kind: Callable[[str], Any], meaning: str, at_least: float | None, secret: bool
) -> Any:
    """What a text means.

    Args:
        place: where it stands, for errors.
        text: the text.
        kind: makes a value of it, or raises ValueError.
        meaning: what the setting sets.
        at_least: the least value that may be, of a number.
        secret: whether the text must not be repeated.
    Raises:
        SettingsError: with place, value, rule and remedy.
    """
    shown = "the value" if secret else _shown(text)
    try:
        value = kind(text)
    except ValueError as error:
        rule = f"{shown} is not {_RULES[kind]}" if kind in _RULES else str(error)
        raise SettingsError(f"{place}: {rule}; it sets the {meaning}") from None
    if at_least is not None and not at_least <= value < float("inf"):
        raise SettingsError(f"{place}: {shown} is not a finite number >= {at_least:g}; it sets the {meaning}")
    return value


def log_format(text: str) -> str:
    """The text, if it is a format of log lines.

    Raises:
        ValueError: it is none.
    """
    if text not in FORMATS:
        raise ValueError(f"{_shown(text)} is not {' or '.join(FORMATS)}")
    return text


def database_url(text: str) -> str:
    """The URL of a PostgreSQL database.

    Raises:
        ValueError: it is none; the message has no password.
    """
    return _server_url(text, "a PostgreSQL database", {"postgresql": "postgresql://user:password@host/name"})


def broker_url(text: str) -> str:
    """The URL of a RabbitMQ virtual host.

    Raises:
        ValueError: it is none; the message has no password.
    """
    example = "amqp://user:password@host/name"
    return _server_url(text, "a RabbitMQ server", {"amqp": example, "amqps": example})


def object_store(text: str) -> str:
    """The URL of a bucket or a directory.

    Raises:
        ValueError: it is none.
    """
    example = "s3://bucket/prefix or file:///directory"
    _parts_of(text, "an object store", dict.fromkeys(("s3", "gs", "az", "file"), example))
    return text


def _server_url(text: str, kind: str, schemes: Mapping[str, str]) -> str:
    """The text, if whoever reads it takes the same for user, password, host and port."""
    parts = _parts_of(text, kind, schemes)
    if parts.netloc.count("@") > 1 or "@" in parts.path + parts.query or parts.fragment:
        raise ValueError(
            "the value has more than one @, or a #; write what is special in user and password in percent-encoding: "
            "%40 for @, %23 for #, %2F for /, %3A for :, %3F for ?, %25 for %"
        )
    try:
        _ = parts.port
    except ValueError:
        raise ValueError(
            "the value has a port that is no number from 0 to 65535; write another, or %2F for / and %3F for ? in user "
            "and password"
        ) from None
    return text


def _parts_of(text: str, kind: str, schemes: Mapping[str, str]) -> SplitResult:
    try:
        parts = urlsplit(text)
    except ValueError:  # its message has pieces of the text
        parts = SplitResult("", "", "", "", "")
    if parts.scheme not in schemes or not (parts.path if parts.scheme == "file" else parts.netloc):
        raise ValueError(f"the value is no URL of {kind}; write one like {next(iter(schemes.values()))}")
    return parts


def parse_origins(text: str) -> tuple[str, ...]:
    """Origins of web pages, between commas or white space, or `*`.

    Raises:
        ValueError: one is no origin.
    """
    origins = tuple(text.replace(",", " ").split())
    for origin in origins:
        if origin != "*" and not re.fullmatch(r"https?://(?:[a-z0-9.-]+|\[[0-9a-f:]+\])(?::\d{1,5})?", origin):
            raise ValueError(f"{_shown(origin)} is no origin; write one like https://example.org, without a path")
    return origins


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
