"""`conicoid serve`: the HTTP service, in the foreground."""

import argparse
import socket
import sys

from conicoid_client.command.connect import settings
from conicoid_client.command.report import Failure


def run(options: argparse.Namespace) -> None:
    """Listen, then answer until SIGINT or SIGTERM."""
    configuration = settings(options.config)
    listener = _listen(options.host, options.port)
    from conicoid_service.errors import SettingsError, StoreError
    from conicoid_service.server import serve

    host, port = listener.getsockname()[:2]
    if sys.stderr is not None:
        print(f"serving http://{f'[{host}]' if ':' in host else host}:{port}", file=sys.stderr, flush=True)
    try:
        started = serve(settings=configuration, listener=listener)
    except (StoreError, SettingsError) as error:
        raise Failure(str(error)) from None
    if not started:
        raise Failure("the service did not start; its log above says why")


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family, backlog=2048)
    except OSError as error:
        reason = error.strerror or str(error)
        raise Failure(
            f"cannot listen on {host} port {port}: {reason.lower()}; choose another --port or --host"
        ) from None
