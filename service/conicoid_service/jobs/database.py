"""The database of the job store: opened, brought up to date, used in transactions."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from sqlalchemy import URL, Connection, Engine, Table, create_engine, event, func, inspect, make_url, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import DatabaseError, DBAPIError, InterfaceError, OperationalError

from conicoid_service.errors import StoreError
from conicoid_service.jobs.clock import now_ms

HEAD: Final = "0002"  # of `migrations/versions`
_WAIT_S: Final = 30.0  # for another server that writes
# A server that has gone, with its machine or its network, is given up within half a minute.
_POSTGRESQL: Final[Mapping[str, Any]] = {
    "connect_timeout": 5,
    "keepalives_idle": 5,
    "keepalives_interval": 2,
    "keepalives_count": 3,
    "tcp_user_timeout": 15_000,
    "options": f"-c lock_timeout={_WAIT_S:.0f}s -c idle_in_transaction_session_timeout=60s -c tcp_keepalives_idle=5"
    " -c tcp_keepalives_interval=2 -c tcp_keepalives_count=3 -c tcp_user_timeout=15000",
    "application_name": "conicoid",
}
# No connection; read-only after a failover; idle too long; rolled back; no resources; lock not had; told to end.
_PASSING: Final = ("08", "25006", "25P03", "40", "53", "55P03", "57", "58")
_KEPT: Final = 4  # connections that stay open
_CLOCK_S: Final = 60.0
_MIGRATING: Final = 0x636F6E69  # advisory lock of whoever changes the schema
_ALONE: Final = 0x636F6E61  # of two keys, so that no second one makes it another lock than those of `alone`


class Database:
    """A SQLite file in WAL mode or a PostgreSQL database, through SQLAlchemy; several servers may share it.

    Args:
        place: the file, made if it is not there; or a `postgresql://` URL.
        migrate: whether to bring the tables up to date; a worker leaves that to the API.
        patient: whether its users try again, so that no connection needs to be tried before it is used.
        threads: how many use it at once.
    Raises:
        StoreError: it cannot be opened, is no database, or was written by a newer version.
    """

    def __init__(self, place: Path | str, *, migrate: bool = True, patient: bool = False, threads: int = 1) -> None:
        self.shared = isinstance(place, str)
        self._engine = _postgresql(place, threads, patient) if isinstance(place, str) else _sqlite(place)
        self._offset_ms, self._read_at = 0, -_CLOCK_S
        shown = self._engine.url.render_as_string(hide_password=True) if self.shared else str(place)
        try:
            if migrate and self._revision() != HEAD:
                from conicoid_service.jobs.migrations import upgrade  # loads Alembic, which a newest store needs not

                with self.writing() as connection:
                    if self.shared:
                        connection.execute(select(func.pg_advisory_xact_lock(_MIGRATING)))
                    upgrade(connection)
            self.read_clock()
        except StoreError as error:
            self.close()
            raise StoreError(f"{shown}: {error}") from None
        except (DatabaseError, InterfaceError, OSError) as error:
            self.close()
            reason = " ".join(str(getattr(error, "orig", None) or error).split())
            setting = "database_url" if self.shared else "data_dir"
            raise StoreError(
                f"{shown}: the job store cannot be opened ({reason}); see `{setting}` in the settings"
            ) from None

    def _revision(self) -> str | None:
        """Alembic's name of the schema that the database has."""
        with self.reading() as connection:
            if not inspect(connection).has_table("alembic_version"):
                return None
            return connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalar()

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """A transaction that reads; in SQLite, one state of the database."""
        with self._engine.connect() as connection, connection.begin():
            yield connection

    @contextmanager
    def writing(self) -> Iterator[Connection]:
        """A transaction that is on the disk when it ends, or undone if an exception leaves it.

        Raises:
            OperationalError, InterfaceError: see `refuses`.
        """
        with self._engine.connect().execution_options(writes=True) as connection, connection.begin():
            yield connection

    def now_ms(self) -> int:
        """Milliseconds since 1970, UTC, by the clock that all who share the database go by."""
        return now_ms() + self._offset_ms

    def read_clock(self) -> None:
        """Compare this machine's clock with the server's, if that was not done within a minute."""
        if not self.shared or time.monotonic() - self._read_at < _CLOCK_S:
            return
        with self.reading() as connection:
            before = now_ms()
            there = connection.execute(select(func.extract("epoch", func.clock_timestamp()) * 1000)).scalar_one()
        self._offset_ms, self._read_at = round(there) - (before + now_ms()) // 2, time.monotonic()

    def session(self) -> Connection:
        """A connection outside of transactions, which the caller closes."""
        return self._engine.connect().execution_options(isolation_level="AUTOCOMMIT")

    def close(self) -> None:
        """Close every connection."""
        self._engine.dispose()


def refuses(error: DBAPIError) -> bool:
    """Whether an error is the disk's, the server's or the network's, so that the same may succeed later."""
    if hasattr(error.orig, "sqlstate"):  # psycopg's
        state = getattr(error.orig, "sqlstate", None) or ""
        return isinstance(error, OperationalError | InterfaceError) or state.startswith(_PASSING)
    code = getattr(error.orig, "sqlite_errorname", "")
    return code.startswith(("SQLITE_FULL", "SQLITE_IOERR", "SQLITE_BUSY", "SQLITE_READONLY", "SQLITE_CANTOPEN"))


def alone(connection: Connection, what: str) -> None:
    """Let nobody else do this to the database until the transaction ends; in SQLite a writer is alone anyway."""
    if connection.dialect.name == "postgresql":
        connection.execute(select(func.pg_advisory_xact_lock(_ALONE, func.hashtext(what))))


def upsert(connection: Connection, table: Table, row: Mapping[str, Any]) -> None:
    """Put a row in, in place of one with the same primary key."""
    insert = postgresql.insert if connection.dialect.name == "postgresql" else sqlite.insert
    key = [column.name for column in table.primary_key]
    rest = {name: value for name, value in row.items() if name not in key}
    connection.execute(insert(table).values(row).on_conflict_do_update(index_elements=key, set_=rest))


def _sqlite(path: Path) -> Engine:
    engine = create_engine(URL.create("sqlite", database=str(path)), connect_args={"timeout": _WAIT_S})
    event.listen(engine, "connect", _on_connect)
    event.listen(engine, "begin", _on_begin)
    return engine


def _postgresql(url: str, threads: int, patient: bool) -> Engine:
    driver = make_url(url).set(drivername="postgresql+psycopg")
    kept = min(threads, _KEPT)
    # One more, for the session of `Leadership`.
    pool = {"pool_pre_ping": not patient, "pool_size": kept, "max_overflow": threads + 1 - kept}
    return create_engine(driver, connect_args=dict(_POSTGRESQL), **pool)


def _on_connect(connection: Any, _: Any) -> None:
    connection.isolation_level = None  # transactions begin where SQLAlchemy says so, in the way of `_on_begin`
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")


def _on_begin(connection: Connection) -> None:
    # A transaction that reads first and writes later would fail, not wait, when another server wrote in between.
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
