"""RabbitMQ, PostgreSQL and an S3-compatible server for tests: real ones, each in a temporary folder of its own.

Each keeps its port and its data when it is stopped, killed and started again. They listen at one address alone, the
loopback's unless told otherwise, and end with the process that started them. From Debian 12: `rabbitmq-server` and
`postgresql`, which need not run as services; rclone comes with the development environment.
"""

import os
import shutil
import signal
import socket
import subprocess
import tempfile
from abc import ABC, abstractmethod
from contextlib import ExitStack, suppress
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import ClassVar, Self

import httpx
import psycopg

from tests.checkout import BIN
from tests.farm.processes import Process, server_port

_PASSWORD = "not-secret"
_BUCKET = "conicoid"
_PATH = "/usr/bin:/bin"


class Server(ABC):
    """A server as a process.

    Attributes:
        user: who it runs as where the tests run as root; the folder is theirs.
        folder: its data and its log.
    """

    user: ClassVar[str | None] = None

    def __init__(self, address: str = "127.0.0.1") -> None:
        self.address, self.port = address, server_port(address)
        self.folder = Path(tempfile.mkdtemp(prefix=f"conicoid-{type(self).__name__.lower()}-"))
        self._process: Process | None = None
        self._names = count()
        if self.user and os.geteuid() == 0:
            shutil.chown(self.folder, self.user, self.user)

    @abstractmethod
    def _started(self) -> Process: ...

    @abstractmethod
    def answers(self) -> bool:
        """Whether it takes work now."""

    def start(self) -> None:
        """Start it and wait until it answers."""
        self.begin()
        self.wait()

    def begin(self) -> None:
        """Start it."""
        assert self._process is None, "it runs already"
        self._process = self._started()

    def wait(self) -> None:
        """Wait until it answers."""
        self.process.wait_until(self.answers)

    @property
    def process(self) -> Process:
        assert self._process is not None, "it does not run"
        return self._process

    def stop(self) -> None:
        """End it in order."""
        self.process.end()
        self._process = None

    def kill(self) -> None:
        """End it as a power failure would."""
        self.process.kill()
        self._process = None

    def restart(self) -> None:
        """Kill it and start it again."""
        self.kill()
        self.start()

    def _run(self, command: list[str], stdin: str = "") -> str:
        """Standard output of one of the server's own programs, run as the server's user."""
        user = self.user if os.geteuid() == 0 else None
        done = subprocess.run(
            command, input=stdin, capture_output=True, text=True, check=False, cwd="/",
            env={"HOME": str(self.folder), "PATH": _PATH}, user=user, group=user, extra_groups=[] if user else None,
        )  # fmt: skip
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
        return done.stdout

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End it and remove its folder."""
        if self._process is not None:
            self.kill()
        shutil.rmtree(self.folder)


def debians(program: str, package: str) -> str:
    """A program that a Debian package brings.

    Raises:
        AssertionError: it is not installed; says how to.
    """
    assert Path(program).exists(), f"{program} is missing: apt-get install --no-install-recommends {package}"
    return program


class Broker(Server):
    """RabbitMQ, with a port mapper (epmd) of its own, and no plugins."""

    user = "rabbitmq"

    def __init__(self, address: str = "127.0.0.1") -> None:
        super().__init__(address)
        self._mapper: Process | None = None
        self._mapper_port, self._peers_port = server_port(), server_port()
        lines = {
            "listeners.tcp.1": f"{address}:{self.port}",
            "default_user": "conicoid",
            "default_pass": _PASSWORD,
            "loopback_users": "none",
            "log.console": "true",
            "log.file": "false",
        }
        text = "".join(f"{key} = {value}\n" for key, value in lines.items())
        (self.folder / "rabbitmq.conf").write_text(text)

    def _started(self) -> Process:
        program = debians("/usr/lib/rabbitmq/bin/rabbitmq-server", "rabbitmq-server")
        folder, log = str(self.folder), self.folder / "log"
        environment = {
            "HOME": folder, "PATH": _PATH, "LANG": "C.UTF-8",
            "ERL_EPMD_PORT": str(self._mapper_port), "ERL_EPMD_ADDRESS": "127.0.0.1",
            "RABBITMQ_NODENAME": "conicoid@localhost", "RABBITMQ_DIST_PORT": str(self._peers_port),
            "RABBITMQ_CONFIG_FILE": f"{folder}/rabbitmq.conf", "RABBITMQ_CONF_ENV_FILE": f"{folder}/none",
            "RABBITMQ_ENABLED_PLUGINS_FILE": f"{folder}/plugins", "RABBITMQ_PID_FILE": f"{folder}/pid",
            "RABBITMQ_MNESIA_BASE": f"{folder}/data", "RABBITMQ_LOG_BASE": f"{folder}/logs",
            "RABBITMQ_SERVER_ADDITIONAL_ERL_ARGS": "-kernel inet_dist_use_interface {127,0,0,1} -start_epmd false",
            "RUNNING_UNDER_SYSTEMD": "true",  # the script then becomes the server instead of waiting for it
        }  # fmt: skip
        if self._mapper is None:
            self._mapper = Process([debians("/usr/bin/epmd", "erlang-base")], log, environment, self.user)
            self._mapper.wait_until(lambda: _accepts("127.0.0.1", self._mapper_port))
        return Process([program], log, environment, self.user)

    def answers(self) -> bool:
        return _accepts(self.address, self.port)  # it listens last of all

    def forget(self) -> None:
        """Lose its data, queues, messages and virtual hosts; it must not run."""
        assert self._process is None
        shutil.rmtree(self.folder / "data")

    def url(self, vhost: str = "") -> str:
        """Of a virtual host, or of the default one."""
        return f"amqp://conicoid:{_PASSWORD}@{self.address}:{self.port}/{vhost or '%2F'}"

    def create(self, vhost: str = "") -> str:
        """A new virtual host, empty; its URL."""
        vhost = vhost or f"test{next(self._names)}"
        self.evaluate(
            f'rabbit_vhost:add(<<"{vhost}">>, <<"tests">>), rabbit_auth_backend_internal:set_permissions('
            f'<<"conicoid">>, <<"{vhost}">>, <<".*">>, <<".*">>, <<".*">>, <<"tests">>)'
        )
        return self.url(vhost)

    def evaluate(self, erlang: str) -> str:
        """What an expression is inside the server, as Erlang writes it; much faster than rabbitmqctl starts."""
        cookie = (self.folder / ".erlang.cookie").read_text()
        call = ["env", f"ERL_EPMD_PORT={self._mapper_port}", debians("/usr/bin/erl_call", "erlang-base")]
        told = self._run([*call, "-n", "conicoid@localhost", "-c", cookie, "-e"], stdin=f"{erlang}.\n")
        assert told.startswith("{ok, "), told
        return told.removeprefix("{ok, ").removesuffix("}")

    def close(self) -> None:
        if self._mapper is not None:
            self._mapper.kill()
        super().close()


class Database(Server):
    """PostgreSQL."""

    user = "postgres"

    def _started(self) -> Process:
        if not (self.folder / "data").exists():
            self._make()
        words = ["-D", f"{self.folder}/data", "-h", self.address, "-p", str(self.port), "-k", ""]
        return Process([_postgres("postgres"), *words], self.folder / "log", {"PATH": _PATH}, self.user)

    def _make(self) -> None:
        """An empty cluster, for users with the password at the addresses that it listens at."""
        password, data = self.folder / "password", self.folder / "data"
        password.write_text(_PASSWORD)
        how = ["--username=conicoid", "--auth=scram-sha-256", f"--pwfile={password}", "--encoding=UTF8"]
        self._run([_postgres("initdb"), f"--pgdata={data}", *how, "--locale=C.UTF-8", "--no-sync"])
        (data / "pg_hba.conf").write_text("host all all samenet scram-sha-256\n")

    def answers(self) -> bool:
        with suppress(psycopg.OperationalError), psycopg.connect(self.url(), connect_timeout=5):
            return True
        return False

    def url(self, database: str = "postgres") -> str:
        return f"postgresql://conicoid:{_PASSWORD}@{self.address}:{self.port}/{database}"

    def create(self, database: str = "") -> str:
        """A new database, empty; its URL."""
        database = database or f"test{next(self._names)}"
        with psycopg.connect(self.url(), autocommit=True) as connection:
            connection.execute(f'CREATE DATABASE "{database}"')
        return self.url(database)

    def stop(self) -> None:
        self.process.end(signal.SIGINT)  # SIGTERM would wait for clients to go
        self._process = None


def _postgres(program: str) -> str:
    found = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{program}"), key=lambda path: int(path.parts[4]))
    return str(found[-1]) if found else debians(f"/usr/lib/postgresql/15/bin/{program}", "postgresql")


class Store(Server):
    """An S3-compatible server over a folder, whose subfolders are buckets, of which it has one: rclone."""

    def _started(self) -> Process:
        buckets = self.folder / "buckets"
        (buckets / _BUCKET).mkdir(parents=True, exist_ok=True)  # before it starts, as it looks rarely
        words = ["serve", "s3", str(buckets), "--addr", f"{self.address}:{self.port}"]
        words += ["--auth-key", f"conicoid,{_PASSWORD}", "--config", ""]
        environment = {"PATH": _PATH, "HOME": str(self.folder)}
        return Process([str(BIN / "rclone"), *words], self.folder / "log", environment)

    def answers(self) -> bool:
        with suppress(httpx.TransportError):
            return httpx.get(self.endpoint).status_code < 500
        return False

    @property
    def endpoint(self) -> str:
        return f"http://{self.address}:{self.port}"

    def create(self) -> str:
        """A new folder in the bucket, empty; its URL."""
        return f"s3://{_BUCKET}/test{next(self._names)}"

    def access(self, endpoint: str = "") -> dict[str, str]:
        """The usual variables for it, or for something between it and its users."""
        endpoint = endpoint or self.endpoint
        return {
            "AWS_ENDPOINT_URL": endpoint, "AWS_ALLOW_HTTP": "true", "AWS_REGION": "us-east-1",
            "AWS_ACCESS_KEY_ID": "conicoid", "AWS_SECRET_ACCESS_KEY": _PASSWORD,
        }  # fmt: skip


class Servers:
    """The three servers, started at the same time.

    Args:
        address: where they listen.
    """

    def __init__(self, address: str = "127.0.0.1") -> None:
        self.broker, self.database, self.store = Broker(address), Database(address), Store(address)
        self._open = ExitStack()

    def environment(self) -> dict[str, str]:
        """Variables of a farm of its own: a new virtual host, database and folder of the bucket."""
        return {
            "CONICOID_BROKER_URL": self.broker.create(),
            "CONICOID_DATABASE_URL": self.database.create(),
            "CONICOID_OBJECT_STORE": self.store.create(),
            **self.store.access(),
        }

    def __enter__(self) -> Self:
        with ExitStack() as opened:
            for server in (self.broker, self.store, self.database):
                opened.callback(server.close)
                server.begin()
            for server in (self.store, self.database, self.broker):
                server.wait()
            self._open = opened.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._open.close()


def _accepts(address: str, port: int) -> bool:
    with suppress(OSError), socket.create_connection((address, port), timeout=5):
        return True
    return False
