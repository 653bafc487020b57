"""Conicoid's HTTP client and the `conicoid` command.

    from conicoid_client import Client

    with Client("http://127.0.0.1:8000") as conicoid:
        rendering = conicoid.render(open("scene.json", "rb").read())

Names load on first use, so that `conicoid --help` does not wait for an HTTP library.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from conicoid_client.client import Client
    from conicoid_client.errors import ClientError, Problem, ProblemError, SceneRejected, ServerBusy, Unreachable
    from conicoid_client.jobs import Frame, FrameEnded, Job, JobEnded, Progress
    from conicoid_client.rendering import Rendering

_HOMES = {
    "Client": "conicoid_client.client",
    "Rendering": "conicoid_client.rendering",
    "Frame": "conicoid_client.jobs",
    "FrameEnded": "conicoid_client.jobs",
    "Job": "conicoid_client.jobs",
    "JobEnded": "conicoid_client.jobs",
    "Progress": "conicoid_client.jobs",
    "ClientError": "conicoid_client.errors",
    "Problem": "conicoid_client.errors",
    "ProblemError": "conicoid_client.errors",
    "SceneRejected": "conicoid_client.errors",
    "ServerBusy": "conicoid_client.errors",
    "Unreachable": "conicoid_client.errors",
}

__all__ = [
    "Client",
    "ClientError",
    "Frame",
    "FrameEnded",
    "Job",
    "JobEnded",
    "Problem",
    "ProblemError",
    "Progress",
    "Rendering",
    "SceneRejected",
    "ServerBusy",
    "Unreachable",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
