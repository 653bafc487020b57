"""Where the stores of the tests are: in their folders; with `--farm`, on a farm's servers."""

from functools import cache
from pathlib import Path

from tests.farm.servers import Servers

servers: Servers | None = None  # set for the whole run


def of(folder: Path) -> dict[str, str]:
    """The settings of a store that is the folder's own."""
    return {} if servers is None else dict(_made(servers, folder))


@cache
def _made(servers: Servers, _: Path) -> dict[str, str]:
    made = servers.environment()
    return {name: made[f"CONICOID_{name.upper()}"] for name in ("broker_url", "database_url", "object_store")}
