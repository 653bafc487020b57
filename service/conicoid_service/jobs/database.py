"""The database of the job store: opened, brought up to date, used by one thread."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from sqlalchemy import URL, Connection, create_engine, event, inspect
from sqlalchemy.exc import DatabaseError, OperationalError

from conicoid_service.errors import StoreError

HEAD: Final = "0001"  # of `migrations/versions`
_WAIT_S: Final = 30.0  # for another server that writes


class Database:
    """A SQLite file in WAL mode, through SQLAlchemy; several servers may share it.

    Args:
        path: the file, made if it is not there.
    Raises:
        StoreError: it cannot be opened, is no database, or was written by a newer version.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._engine = create_engine(URL.create("sqlite", database=str(path)), connect_args={"timeout": _WAIT_S})
        event.listen(self._engine, "connect", _on_connect)
        event.listen(self._engine, "begin", _on_begin)
        try:
            if self._revision() != HEAD:
                from conicoid_service.jobs.migrations import upgrade  # loads Alembic, which a newest store needs not

                with self.writing() as connection:
                    upgrade(connection)
        except StoreError as error:
            self.close()
            raise StoreError(f"{path}: {error}") from None
        except (DatabaseError, OSError) as error:
            self.close()
            reason = getattr(error, "orig", None) or error
            raise StoreError(
                f"{path}: the job store cannot be opened ({reason}); see `data_dir` in the settings"
            ) from None

    def _revision(self) -> str | None:
        """Alembic's name of the schema that the file has."""
        with self.reading() as connection:
            if not inspect(connection).has_table("alembic_version"):
                return None
            return connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalar()

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """A transaction that sees one state of the database."""
        with self._engine.connect() as connection, connection.begin():
            yield connection

    @contextmanager
    def writing(self) -> Iterator[Connection]:
        """A transaction that is on the disk when it ends, or undone if an exception leaves it.

        Raises:
            OperationalError: the disk is full or not writable, or another server kept the file locked for too long.
        """
        with self._engine.connect().execution_options(writes=True) as connection, connection.begin():
            yield connection

    def close(self) -> None:
        """Close every connection."""
        self._engine.dispose()


def disk_refuses(error: OperationalError) -> bool:
    """Whether an error is the disk's or another server's, so that the same may succeed later."""
    code = getattr(error.orig, "sqlite_errorname", "")
    return code.startswith(("SQLITE_FULL", "SQLITE_IOERR", "SQLITE_BUSY", "SQLITE_READONLY", "SQLITE_CANTOPEN"))


def _on_connect(connection: Any, _: Any) -> None:
    connection.isolation_level = None  # transactions begin where SQLAlchemy says so, in the way of `_on_begin`
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")


def _on_begin(connection: Connection) -> None:
    # A transaction that reads first and writes later would fail, not wait, when another server wrote in between.
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
