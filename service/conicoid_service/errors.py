"""Every error that the service itself raises, on one page; `docs/errors.md` explains the codes."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, Self

from conicoid.errors import ConicoidError, Problem

DEFECT = "this request met a defect; the server's log has the details"


class ServiceError(ConicoidError):
    """Base of the service's own errors.

    Attributes:
        retry_after_s: when a client may try again, where that helps.
        headers: what else the response says in its headers.
    """

    code = "internal"
    retry_after_s: int | None = None
    headers: Mapping[str, str] = MappingProxyType({})


class UnauthorizedError(ServiceError):
    """The request has no API key that is let in."""

    code = "unauthorized"
    headers = MappingProxyType({"WWW-Authenticate": "Bearer"})


class QuotaError(ServiceError):
    """The API key has as many requests under way as it may."""

    code = "quota"
    retry_after_s = 1


class HeadTimeoutError(ServiceError):
    """The head of a request did not arrive in time."""

    code = "head-timeout"
    headers = MappingProxyType({"Connection": "close"})


class HeadLimitError(ServiceError):
    """The head of a request is too long."""

    code = "head-limit"
    headers = MappingProxyType({"Connection": "close"})


class ConnectionLimitError(ServiceError):
    """As many connections are open as may."""

    code = "connection-limit"
    retry_after_s = 1
    headers = MappingProxyType({"Connection": "close"})


class BodyTimeoutError(ServiceError):
    """The body of a request arrives too slowly."""

    code = "body-timeout"
    headers = MappingProxyType({"Connection": "close"})


class ParameterError(ServiceError):
    """The query names a part that the document does not have."""

    code = "parameter"


class MediaTypeError(ServiceError):
    """The body is not of a type that the route reads."""

    code = "media-type"


class ContentEncodingError(ServiceError):
    """The body is compressed in another way than gzip."""

    code = "content-encoding"
    headers = MappingProxyType({"Accept-Encoding": "gzip"})


class CompressedDataError(ServiceError):
    """The body is not the gzip that it says it is, or ends too early."""

    code = "content-encoding-data"


class MultipartError(ServiceError):
    """The body is not the `multipart/form-data` that it says it is, or has other parts than the route reads."""

    code = "multipart"


class UnknownSceneError(ServiceError):
    """No quadrics are kept under this id: they never were, or were dropped for others."""

    code = "unknown-scene"


class QueueFullError(ServiceError):
    """More requests wait than the queue holds."""

    code = "queue-full"
    retry_after_s = 1


class OutOfMemoryError(ServiceError):
    """The request needs more memory than the process that works on it may have."""

    code = "memory"


class GivenUpError(ServiceError):
    """Nobody waits for the request any more; nobody gets this error either."""


class RenderCrashedError(ServiceError):
    """The process that worked on the request died, and so did its replacement."""

    code = "render-crashed"


class RenderTimeoutError(ServiceError):
    """The request took longer than the deadline, twice."""

    code = "render-timeout"


class UnavailableError(ServiceError):
    """A process that the request needs cannot be started, for now."""

    code = "render-unavailable"
    retry_after_s = 10


class NotReadyError(ServiceError):
    """The processes are still starting; only `/readyz` says so, requests wait."""

    code = "not-ready"
    retry_after_s = 1


class StoppingError(ServiceError):
    """The service is shutting down."""

    code = "stopping"
    retry_after_s = 5


class UnknownJobError(ServiceError):
    """There is no such job: there never was, its time is over, or it is another owner's."""

    code = "unknown-job"


class FrameNotReadyError(ServiceError):
    """The frame has no image: it waits, is being rendered, was cancelled, or the job has no frame of that number."""

    code = "frame-not-ready"


class FrameFailedError(ServiceError):
    """The frame has no image and will have none."""

    code = "frame-failed"


class IdempotencyKeyError(ServiceError):
    """The `Idempotency-Key` is no key, or was used for another job."""

    code = "idempotency-key"


class JobLimitError(ServiceError):
    """The owner has too many frames that have not ended."""

    code = "job-limit"
    retry_after_s = 10


class StorageError(ServiceError):
    """The disk does not take what has to be kept, for now."""

    code = "storage"
    retry_after_s = 10


class BandsError(ServiceError):
    """Bands are damaged, or are not those of the frame that they are to be joined to."""

    code = "bands"


class NoJobsError(ServiceError):
    """This service has no job store: the command runs it for one render."""

    code = "no-jobs"


class StoreError(ServiceError):
    """The job store cannot be opened; raised at start, never sent over HTTP."""

    code = "store"


class BrokerError(ServiceError):
    """A farm's broker cannot be reached, for now; never sent over HTTP: jobs are accepted all the same."""

    code = "broker"


class SettingsError(ServiceError):
    """A setting in the environment or the file is not usable; raised at start, never sent over HTTP."""

    code = "settings"


class ReportedError(ServiceError):
    """An error that a child process reported: the child's code, paragraph and places."""

    def __init__(
        self,
        code: str,
        detail: str,
        problems: Sequence[Problem] = (),
        limit: int | None = None,
        asked: int | None = None,
    ) -> None:
        super().__init__(detail)
        self.code = code
        self.problems = tuple(problems)
        self.limit, self.asked = limit, asked

    @classmethod
    def from_report(cls, report: Mapping[str, Any]) -> Self:
        """The error that `worker.failure` made a message of."""
        problems = [Problem(*problem) for problem in report.get("problems", ())]
        return cls(report["code"], report["detail"], problems, report.get("limit"), report.get("asked"))
