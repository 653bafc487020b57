"""Log lines of all processes: text for people, or JSON for machines."""

import json
import logging
import re
from typing import Any, Final

from conicoid_service.telemetry import context

FORMATS: Final = ("text", "json")
LOG_FORMAT: Final = "CONICOID_LOG_FORMAT"  # told to child processes, whose first lines come before any message

_PLAIN: Final = re.compile(r"[\w./:+-]+", re.ASCII)
_OWN: Final = frozenset({*vars(logging.makeLogRecord({})), "message", "asctime", "taskName", "color_message"})


class TextFormatter(logging.Formatter):
    """`2026-01-01 00:00:00,000 INFO conicoid_service.x: message key=value`; control characters are escaped."""

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)s %(name)s: %(message)s")

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  # logging's name
        """The line without a traceback."""
        line = super().formatMessage(record)
        escaped = "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in line)
        return " ".join((escaped, *(f"{name}={_shown(value)}" for name, value in fields(record).items())))


def fields(record: logging.LogRecord) -> dict[str, Any]:
    """The ids of the context and what the caller gave as `extra`."""
    return context.ids() | {name: value for name, value in vars(record).items() if name not in _OWN}


def configure(log_format: str, level: str = "info") -> None:
    """Have this process log to standard error; in place of what it did before."""
    handler = logging.StreamHandler()
    handler.setFormatter(_json_formatter() if log_format == "json" else TextFormatter())
    logging.basicConfig(handlers=[handler], level=logging.WARNING, force=True)
    for name in ("conicoid_service", "uvicorn"):
        logging.getLogger(name).setLevel(level.upper())


def _json_formatter() -> logging.Formatter:
    from pythonjsonlogger.orjson import OrjsonFormatter  # text needs none

    class JsonFormatter(OrjsonFormatter):
        """A JSON object in a line, with the ids of the context."""

        def add_fields(self, log_data: dict[str, Any], record: logging.LogRecord, message_dict: dict[str, Any]) -> None:
            """Fill in the object."""
            super().add_fields(log_data, record, message_dict)
            log_data.update({name: value for name, value in context.ids().items() if name not in log_data})

    return JsonFormatter(
        ["levelname", "name", "message"],
        rename_fields={"levelname": "level", "name": "logger", "exc_info": "traceback"},
        reserved_attrs=sorted(_OWN),
        timestamp="time",
    )


def _shown(value: object) -> str:
    text = str(value)
    return text if _PLAIN.fullmatch(text) else json.dumps(value, default=str)
