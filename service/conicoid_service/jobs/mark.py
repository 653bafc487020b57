"""What says of a farm's object store which database it belongs to."""

import secrets
import time
from typing import Final

from sqlalchemy import insert, select

from conicoid_service.blob import Blob
from conicoid_service.jobs.database import Database, alone
from conicoid_service.jobs.files import Files
from conicoid_service.jobs.tables import identity

_BELIEVED_S: Final = 10.0


class Mark:
    """A file named like the database: where it is missing, so may be everything that the database knows of."""

    def __init__(self, files: Files, database: Database, *, sets: bool) -> None:
        """A file of `files`; with `sets` it is written once, when the database has no name yet."""
        self._files, self._database, self._sets = files, database, sets
        self._seen_at = -_BELIEVED_S

    def is_set(self) -> bool:
        """Whether the file is there, or was a moment ago.

        Raises:
            OSError: the store does not say, or does not take it.
        """
        if time.monotonic() - self._seen_at < _BELIEVED_S:
            return True
        with self._database.reading() as connection:
            name = connection.execute(select(identity.c.name)).scalar()
        if name is None and self._sets:
            name = self._set()
        if name is None or self._files.size(name) is None:
            return False
        self._seen_at = time.monotonic()
        return True

    def _set(self) -> str:
        """Name the database and write the file: both, or neither."""
        with self._database.writing() as connection:
            alone(connection, "identity")
            name: str | None = connection.execute(select(identity.c.name)).scalar()
            if name is None:
                name = secrets.token_hex(16)
                connection.execute(insert(identity).values(name=name))
                with Blob.of(b"A farm of Conicoid keeps its files here.\n") as blob:
                    self._files.write(name, blob)
            return name
