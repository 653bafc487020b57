"""The document process, but a body `crash` ends it."""

import os
import sys

from conicoid_service import document_process
from conicoid_service.blob import Blob
from conicoid_service.channel import Message
from conicoid_service.worker import Handler, Reply, serve


def start(_: Message) -> tuple[Handler, Message]:
    return handle, {}


def handle(message: Message, blobs: list[Blob]) -> Reply:
    if blobs[0].read() == b"crash":
        os.abort()
    return document_process.handle(message, blobs)


if __name__ == "__main__":
    serve(start, sys.argv[1:])
