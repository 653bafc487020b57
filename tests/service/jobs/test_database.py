"""The database's file: new, old, of the future, broken."""

import sqlite3
from importlib.resources import files
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy.exc import DatabaseError

from conicoid_service.errors import StoreError
from conicoid_service.jobs.database import HEAD, Database
from conicoid_service.jobs.tables import metadata


def test_migrations_lead_to_the_tables_that_the_code_uses(tmp_path: Path) -> None:
    database = Database(tmp_path / "jobs.sqlite")
    with database.reading() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []
    database.close()


def test_newest_schema_is_the_last_migration() -> None:
    config = Config()
    config.set_main_option("script_location", str(files("conicoid_service.jobs") / "migrations"))
    assert ScriptDirectory.from_config(config).get_current_head() == HEAD


def test_store_of_a_newer_version_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "jobs.sqlite"
    Database(path).close()
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE alembic_version SET version_num = 'from the future'")
    with pytest.raises(StoreError, match="schema 'from the future', which this version does not know"):
        Database(path)
    with sqlite3.connect(path) as connection:
        assert connection.execute("SELECT version_num FROM alembic_version").fetchone() == ("from the future",)


@pytest.mark.parametrize(
    "content", [b"this is no database, but long enough to look like one" * 99, b"SQLite format 3\0"]
)
def test_file_that_is_no_database_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "jobs.sqlite"
    path.write_bytes(content)
    with pytest.raises(StoreError, match="cannot be opened"):
        Database(path)
    assert path.read_bytes() == content


def test_transaction_that_an_exception_leaves_is_undone(tmp_path: Path) -> None:
    database = Database(tmp_path / "jobs.sqlite")
    insert = "INSERT INTO images VALUES ('tag', 1, '', '', 0, 0, 0)"
    with pytest.raises(DatabaseError), database.writing() as connection:  # noqa: PT012  # the first goes, the second not
        connection.exec_driver_sql(insert)
        connection.exec_driver_sql(insert)
    with database.reading() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM images").scalar() == 0
    database.close()
