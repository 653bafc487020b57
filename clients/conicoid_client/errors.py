"""Every error the client raises, on one page."""

from collections.abc import Sequence
from dataclasses import dataclass


class ClientError(Exception):
    """Base of all of the client's own errors; the message is one readable paragraph."""


class Unreachable(ClientError):
    """No answer from the server: refused, unknown host, broken connection, timeout."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a document.

    Attributes:
        pointer: place in the document, as in `quadrics[3].radius`; empty for the whole document.
        message: value, rule and remedy: `-1 is not > 0; give a positive radius`.
        code: stable code of this kind of problem, as in `scene-value`; empty where the service gave none.
    """

    pointer: str
    message: str
    code: str

    def __str__(self) -> str:
        place = f"{self.pointer}: " if self.pointer else ""
        return place + self.message + (f" [{self.code}]" if self.code else "")


class ProblemError(ClientError):
    """The service answered with an error (RFC 9457 problem+json).

    Attributes:
        status: HTTP status.
        code: stable code of docs/errors.md; `http-<status>` where the answer was not problem+json.
        detail: what happened, for people.
        problems: the places in the document that are wrong, as many as the service reported.
    """

    def __init__(self, status: int, code: str, detail: str, problems: Sequence[Problem] = ()) -> None:
        super().__init__("\n".join([f"{detail} [{code}]", *map(str, problems)]))
        self.status, self.code, self.detail, self.problems = status, code, detail, tuple(problems)


class SceneRejected(ProblemError):
    """The document breaks the contract or asks for more than a limit allows: the same request fails again."""


class ServerBusy(ProblemError):
    """429 or 503, still after the retries.

    Attributes:
        retry_after: seconds the service asked to wait; None where it did not say.
    """

    def __init__(
        self, status: int, code: str, detail: str, problems: Sequence[Problem] = (), retry_after: float | None = None
    ) -> None:
        super().__init__(status, code, detail, problems)
        self.retry_after = retry_after
