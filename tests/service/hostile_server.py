"""A server whose render process is fake, in a process of its own, whose memory and descriptors can be looked at."""

import socket
import sys
from pathlib import Path

from conicoid_service.app import create_app
from conicoid_service.pipeline import Pipeline
from conicoid_service.server import server_of
from conicoid_service.settings import Settings
from tests.service.conftest import FAKE

if __name__ == "__main__":
    chosen = Settings(
        data_dir=Path(sys.argv[1]),
        body_limit=8 << 20,
        head_timeout_s=0.5,
        body_timeout_s=0.5,
        image_cache_limit=0,
        deadline_s=20.0,
    )
    listener = socket.create_server(("127.0.0.1", 0), backlog=100)
    print(listener.getsockname()[1], flush=True)
    server_of(create_app(chosen, Pipeline(chosen, FAKE)), chosen, log_level="warning").run([listener])
