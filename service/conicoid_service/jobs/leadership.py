"""Which of a farm's API processes does what one must do alone."""

import threading
from typing import Final

from sqlalchemy import Connection, func, select
from sqlalchemy.exc import DBAPIError

from conicoid_service.jobs.database import Database

_LOCK: Final = 0x636F6E6C


class Leadership:
    """A lock that a PostgreSQL session holds: the server gives it to another when the session ends, however it ends.

    With SQLite every server leads: they are on one machine, and what they do twice is done at most once.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self._mutex = threading.Lock()
        self._session: Connection | None = None

    def leads(self) -> bool:
        """Whether this process is the one; it becomes so if there is none.

        Raises:
            DBAPIError: the server cannot be asked.
        """
        if not self._database.shared:
            return True
        with self._mutex:
            if self._session is None:
                session = self._database.session()
                try:
                    won = session.execute(select(func.pg_try_advisory_lock(_LOCK))).scalar_one()
                except DBAPIError:
                    session.close()
                    raise
                if not won:
                    session.close()
                    return False
                self._session = session
            try:
                self._session.execute(select(1))
            except DBAPIError:
                self.resign()
                raise
            return True

    def resign(self) -> None:
        """Leave it to others."""
        session, self._session = self._session, None
        if session is not None:
            session.invalidate()  # so that the server ends the session, and no other user of the pool gets the lock
            session.close()
