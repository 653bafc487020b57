"""Serving the application over HTTP."""

import asyncio
import os
import resource
import signal
import socket
import threading
from functools import partial
from types import FrameType
from typing import TYPE_CHECKING, Any, cast

from conicoid_service.heap import keep_freed_memory
from conicoid_service.pipeline import Pipeline
from conicoid_service.settings import Settings, forget_secrets
from conicoid_service.telemetry.logs import LOG_FORMAT, configure

if TYPE_CHECKING:
    import uvicorn
    from fastapi import FastAPI

# Shorter than the 10 s that container runtimes wait before they kill.
GRACE_S = 8
# Kept images and scenes, children, the requests' bodies.
_OWN_DESCRIPTORS = 4096


def serve(
    host: str = "127.0.0.1",
    port: int = 8000,
    *,
    settings: Settings | None = None,
    listener: socket.socket | None = None,
    log_level: str = "info",
) -> bool:
    """Serve until SIGINT or SIGTERM; requests under way get `GRACE_S` seconds to finish.

    Args:
        host: address to bind; port 0 takes a free one, which the log names.
        port: see `host`.
        settings: None reads them from the environment.
        listener: a bound socket in place of host and port.
        log_level: of the service and of uvicorn.
    Returns:
        Whether the service came up at all.
    Raises:
        SettingsError: the environment's settings are unusable, or it asks for traces that cannot be had.
        StoreError: the job store cannot be opened.
        SystemExit: the address cannot be bound.
    """
    settings = settings or Settings.from_environment()
    keep_freed_memory()
    os.environ[LOG_FORMAT] = settings.log_format
    configure(settings.log_format, log_level)
    forget_secrets()
    _allow_descriptors(settings.connection_limit + _OWN_DESCRIPTORS)
    pipeline = Pipeline(settings)
    pipeline.start()
    try:
        # Loading these takes as long as starting the children, which goes on meanwhile.
        from conicoid_service.app import create_app
        from conicoid_service.jobs.storage import Storage

        app = create_app(settings, pipeline, storage=Storage(settings))
        server = server_of(app, settings, host=host, port=port, log_config=None)
    except BaseException:  # a signal's, too: the pipeline's threads would keep the process
        asyncio.run(pipeline.stop())
        raise
    if threading.current_thread() is threading.main_thread():
        # From now on, not only once uvicorn listens to them; it also sends itself the signal again when it has stopped.
        for ending in (signal.SIGINT, signal.SIGTERM):
            signal.signal(ending, server.handle_exit)
    server.run(sockets=None if listener is None else [listener])
    return server.started


def server_of(app: "FastAPI", settings: Settings, **options: Any) -> "uvicorn.Server":
    """A server of the application whose connections keep to the settings; `options` are `uvicorn.Config`'s."""
    import uvicorn

    from conicoid_service.access.connection import Connection

    config = uvicorn.Config(
        app,
        http=cast("Any", partial(Connection, settings)),  # called with uvicorn's arguments alone, like a class
        ws="none",
        access_log=False,  # `telemetry.requests` has a line for each request
        lifespan="on",
        timeout_graceful_shutdown=GRACE_S,
        server_header=False,
        **options,
    )

    class Server(uvicorn.Server):
        def handle_exit(self, sig: int, frame: FrameType | None) -> None:
            """Tell whoever asks `/readyz` at once, while connections are still open."""
            app.state.readiness.draining = True
            super().handle_exit(sig, frame)

        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            """Wait for requests under way, but not for those that only watch a job."""
            if app.state.jobs is not None:
                app.state.jobs.drain()
            await super().shutdown(sockets)

    return Server(config)


def _allow_descriptors(most: int) -> None:
    """Raise the limit of open descriptors, 1,024 as a rule, to `most` if the system lets."""
    usual, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = most if hard == resource.RLIM_INFINITY else min(most, hard)
    if usual != resource.RLIM_INFINITY and usual < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
