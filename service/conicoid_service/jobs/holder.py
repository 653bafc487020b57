"""Which servers of a store live: each holds a lock while it does."""

import fcntl
import os
import secrets
import socket
from pathlib import Path


class Holder:
    """This server's name in the store, and a lock that shows others on this machine that it lives.

    Args:
        path: folder of all holders' locks.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        path.mkdir(parents=True, exist_ok=True)
        self.name = secrets.token_hex(8)
        self._lock = (path / f"{self.name}.new").open("xb")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        # Under the name by which others look for it only when it is locked.
        (path / f"{self.name}.new").rename(path / self.name)

    def lives(self, name: str) -> bool:
        """Whether a server still has its lock, which the kernel takes from it when it dies, however it dies."""
        try:
            with (self._path / name).open("rb") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except FileNotFoundError:
            return False
        except BlockingIOError:
            return True
        (self._path / name).unlink(missing_ok=True)
        return False

    def close(self) -> None:
        """Give the lock up."""
        (self._path / self.name).unlink(missing_ok=True)
        self._lock.close()


class Named:
    """A name alone, for servers on many machines: they say in the database that they live (`Work.renew`)."""

    def __init__(self) -> None:
        self.name = f"{socket.gethostname()[:12]}-{os.getpid()}-{secrets.token_hex(3)}"[:32]

    def close(self) -> None:
        """Nothing is held."""
