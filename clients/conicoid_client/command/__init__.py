"""The `conicoid` command: one module per subcommand, loaded when it is asked for."""

from conicoid_client.command.main import main

__all__ = ["main"]
