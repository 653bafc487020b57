"""How a job store of any earlier version becomes one of this version (Alembic)."""

from importlib.resources import as_file, files

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection

from conicoid_service.errors import StoreError


def upgrade(connection: Connection) -> None:
    """Bring the tables up to date, within the connection's transaction.

    Raises:
        StoreError: a newer version made them.
    """
    with as_file(files(__name__)) as folder:
        config = Config()
        config.set_main_option("script_location", str(folder).replace("%", "%%"))
        config.attributes["connection"] = connection
        found = MigrationContext.configure(connection).get_current_revision()
        known = {one.revision for one in ScriptDirectory.from_config(config).walk_revisions()}
        if found is not None and found not in known:
            raise StoreError(
                f"the job store is of schema {found!r}, which this version does not know; run the version that wrote "
                "it or a newer one, or give another `data_dir`"
            )
        command.upgrade(config, "head")
