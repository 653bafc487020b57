"""`conicoid serve`: the HTTP service, in the foreground."""

import argparse
import socket
import sys

from conicoid_client.command.connect import settings
from conicoid_client.command.report import Failure


def run(options: argparse.Namespace) -> None:
    """Listen, then answer until SIGINT or SIGTERM."""
    listener = _listen(options.host, options.port)
    import uvicorn
    from conicoid_service.app import create_app

    # Shorter than the grace of a container runtime (10 s), so that a stop is orderly.
    config = uvicorn.Config(create_app(settings()), timeout_graceful_shutdown=8, server_header=False)
    service = uvicorn.Server(config)
    service.run(sockets=[listener])
    if not service.started:
        sys.exit(1)


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family, backlog=2048)
    except OSError as error:
        reason = error.strerror or str(error)
        raise Failure(
            f"cannot listen on {host} port {port}: {reason.lower()}; choose another --port or --host"
        ) from None
