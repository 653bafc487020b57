"""Serving the application over HTTP."""

import asyncio
import signal
import socket
import threading

from conicoid_service.errors import StoreError
from conicoid_service.heap import keep_freed_memory
from conicoid_service.pipeline import Pipeline
from conicoid_service.settings import Settings

# Shorter than the 10 s that container runtimes wait before they kill.
GRACE_S = 8


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
        log_level: uvicorn's word.
    Returns:
        Whether the service came up at all.
    Raises:
        SettingsError: the environment's settings are unusable.
        StoreError: the job store cannot be opened.
        SystemExit: the address cannot be bound.
    """
    settings = settings or Settings.from_environment()
    keep_freed_memory()
    pipeline = Pipeline(settings)
    pipeline.start()
    # Loading these takes as long as starting the children, which goes on meanwhile.
    import uvicorn

    from conicoid_service.app import create_app
    from conicoid_service.jobs.disk import Disk

    try:
        disk = Disk(settings)
    except StoreError:
        asyncio.run(pipeline.stop())
        raise
    app = create_app(settings, pipeline, disk=disk)
    config = uvicorn.Config(
        app,
        host=host,
        port=port,
        log_level=log_level,
        timeout_graceful_shutdown=GRACE_S,
        server_header=False,
    )

    class Server(uvicorn.Server):
        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            """Wait for requests under way, but not for those that only watch a job."""
            app.state.jobs.drain()
            await super().shutdown(sockets)

    server = Server(config)
    if threading.current_thread() is threading.main_thread():
        # uvicorn sends itself the signal again once it has stopped; an orderly stop is no failure.
        for ending in (signal.SIGINT, signal.SIGTERM):
            signal.signal(ending, lambda *_: None)
    server.run(sockets=None if listener is None else [listener])
    return server.started
