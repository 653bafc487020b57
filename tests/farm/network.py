"""A network of its own for a process, joined to the machine's by a cable that can be pulled; needs root, iproute2."""

import os
import random
import subprocess
from pathlib import Path
from types import TracebackType
from typing import Self

from tests.farm.processes import until


class Network:
    """A network namespace that goes away with the tests, and its pair of virtual links.

    Attributes:
        address: the machine's on the link. Servers that processes inside shall reach have to listen there.
        peer: the address of those inside.
        inside: words before a command that shall have this network alone.
    """

    def __init__(self) -> None:
        assert os.geteuid() == 0, "only root can make networks"
        prefix = f"10.{random.randrange(200, 250)}.{random.randrange(256)}"
        self.address, self.peer = f"{prefix}.1", f"{prefix}.2"
        holder = ["setpriv", "--pdeathsig=KILL", "unshare", "--net", "sleep", "infinity"]
        self._holder = subprocess.Popen(holder)
        self._link = f"cut{self._holder.pid}"
        self.inside = ("nsenter", f"--net=/proc/{self._holder.pid}/ns/net")
        until(self._is_apart, "a network namespace of its own", 10)
        self._ip(f"link add {self._link} type veth peer name eth0 netns {self._holder.pid}")
        self._ip(f"address add {self.address}/30 dev {self._link}")
        self._ip(f"link set {self._link} up")
        self._ip("link set lo up", inside=True)
        self._ip(f"address add {self.peer}/30 dev eth0", inside=True)
        self._ip("link set eth0 up", inside=True)

    def _is_apart(self) -> bool:
        return Path(f"/proc/{self._holder.pid}/ns/net").readlink() != Path("/proc/self/ns/net").readlink()

    def _ip(self, words: str, inside: bool = False) -> None:
        subprocess.run([*(self.inside if inside else ()), "ip", *words.split()], check=True)

    def pull(self) -> None:
        """Lose every packet, as when a cable is pulled: no connection ends, and nothing is refused."""
        self._ip(f"link set {self._link} down")

    def plug(self) -> None:
        """Join it again."""
        self._ip(f"link set {self._link} up")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._holder.kill()
        self._holder.wait()
