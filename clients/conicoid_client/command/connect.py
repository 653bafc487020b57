"""The service that a command talks to: a running one, or the same application in this process."""

import argparse
import logging
import os
from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

from conicoid_client.command.report import Failure, UsageError
from conicoid_client.errors import ClientError

if TYPE_CHECKING:
    from conicoid_client.client import Client
    from conicoid_service.settings import Settings


def server(options: argparse.Namespace) -> str | None:
    """The address of a running service, from the command line or the environment."""
    return options.server or os.environ.get("CONICOID_SERVER") or None


def connect_to_server(options: argparse.Namespace, patience_s: float = 2.0) -> "Client":
    """A client of a running service, which may be away for `patience_s` seconds.

    Raises:
        UsageError: none is named, or its address or the API key is not one.
    """
    from conicoid_client.client import Client

    if (address := server(options)) is None:
        raise UsageError("jobs need a running service; name it with --server URL or CONICOID_SERVER")
    try:
        return Client(address, api_key=os.environ.get("CONICOID_API_KEY") or None, patience_s=patience_s)
    except ClientError as error:
        raise UsageError(str(error)) from None


def settings(file: str | None = None) -> "Settings":
    """The service's settings, from the environment and a file."""
    from conicoid_service.errors import SettingsError
    from conicoid_service.settings import Settings

    try:
        return Settings.from_environment(file=file)
    except SettingsError as error:
        raise Failure(str(error)) from None


def connect(options: argparse.Namespace, warm: Collection[str] = ("document", "render")) -> "Client":
    """A client of that service, or of one that lives as long as the client and starts processes as `Pipeline` does."""
    if server(options) is not None:
        return connect_to_server(options)
    from conicoid_service.pipeline import Pipeline

    configuration = settings()
    configuration = replace(configuration, api_keys=type(configuration.api_keys)())  # nobody else can ask it
    # What goes wrong comes back in the answer; a log beside it on the terminal would say it twice.
    logging.getLogger().addHandler(logging.NullHandler())
    pipeline = Pipeline(configuration, warm=warm)
    pipeline.start()
    # Loading these takes as long as starting the children, which goes on meanwhile.
    from conicoid_client.client import Client
    from conicoid_client.local import LocalTransport
    from conicoid_service.app import create_app

    # Nobody else uses this service, so there is nothing to wait for and no sense in a retry.
    application = create_app(configuration, pipeline, keeps_jobs=False)
    return Client("http://conicoid", transport=LocalTransport(application), retries=0, patience_s=0)
