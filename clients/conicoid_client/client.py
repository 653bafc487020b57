"""Talking to a Conicoid service over HTTP, or to one in this process."""

import re
import secrets
from collections.abc import Iterator, Mapping
from types import TracebackType
from typing import Any, BinaryIO, Literal, Self, overload
from urllib.parse import parse_qsl, urlsplit

import httpx

from conicoid_client import events as event_streams
from conicoid_client.bodies import Arrays, Body, Scene, body, json_bytes
from conicoid_client.connection import Connection
from conicoid_client.errors import ClientError
from conicoid_client.jobs import Event, Frame, Job, JobEnded, checked_id
from conicoid_client.precision import with_precision
from conicoid_client.rendering import Rendering, read_rendering, tag_of

_EXR, _JSON = "image/x-exr", "application/json"
_IDEMPOTENCY_KEY = re.compile(r"[\x21-\x7e]{1,255}")


class Client:
    """A connection to a Conicoid service; use it as a context manager, or close() it.

    Args:
        base_url: the service's address, as in `http://127.0.0.1:8000`.
        api_key: what the service knows you by; it is sent to that address and nowhere else.
        transport: another way to reach it, such as `conicoid_client.local.LocalTransport`.
        timeout_s: longest wait for the answer to one request; connecting takes at most 10 s of it.
        retries: how often a request is repeated that the service answered with 429 or 503 and a `Retry-After`;
            without the header there is nothing to wait for, and the error is raised at once.
        patience_s: how long a request is repeated, at growing intervals, while nobody answers or the connection
            breaks, as when the service starts anew; 0 to fail at once.

    Raises:
        Unreachable: from every call, when there is no answer.
        ProblemError: from every call, when the answer is an error; `SceneRejected` and `ServerBusy` are kinds of it.
    """

    def __init__(
        self,
        base_url: str = "http://127.0.0.1:8000",
        *,
        api_key: str | None = None,
        transport: httpx.BaseTransport | None = None,
        timeout_s: float = 600.0,
        retries: int = 4,
        patience_s: float = 2.0,
    ) -> None:
        self._patience_s = patience_s
        self._connection = Connection(
            base_url,
            api_key=api_key,
            transport=transport,
            timeout_s=timeout_s,
            retries=retries,
            patience_s=patience_s,
        )

    @overload
    def render(
        self,
        scene: Scene,
        *,
        arrays: Arrays | None = None,
        precision: str | None = None,
        frame: int | None = None,
        band: str | None = None,
    ) -> Rendering: ...

    @overload
    def render(
        self,
        scene: Scene,
        *,
        arrays: Arrays | None = None,
        precision: str | None = None,
        frame: int | None = None,
        band: str | None = None,
        etag: str,
    ) -> Rendering | None: ...

    def render(
        self,
        scene: Scene,
        *,
        arrays: Arrays | None = None,
        precision: str | None = None,
        frame: int | None = None,
        band: str | None = None,
        etag: str | None = None,
    ) -> Rendering | None:
        """Render a scene with one camera, or one frame of many.

        Args:
            scene: the document as JSON text, sent as it is, or as a mapping.
            arrays: what the document's sets name as `"@name"`: by name, or as the bytes of an `.npz` file.
            precision: `exact`, `float64` or `float32` in place of the document's `output.precision`.
            frame: which of the document's cameras, from 0; it must have one alone where this is None.
            band: `I/N`, band I (from 0) of the N into which the frame's rows are cut; `conicoid join` joins them.
            etag: tag of the rendering that is already here.
        Returns:
            The rendering; None where `etag` is still its tag.
        """
        document = json_bytes(scene)
        if precision is not None:
            document = with_precision(document, precision)
        headers = {} if etag is None else {"If-None-Match": etag}
        part = {"frame": frame, "band": band}
        query = {name: value for name, value in part.items() if value is not None}
        sent = body(document, arrays)
        response = self._connection.send("POST", "/v1/render", _EXR, body=sent, headers=headers, query=query)
        if response.status_code == httpx.codes.NOT_MODIFIED:
            return None
        return read_rendering(response)

    def canonical(self, scene: Scene, *, arrays: Arrays | None = None) -> bytes:
        """The scene's canonical form: everything resolved, every default filled in, as JSON text.

        It needs no arrays any more. The arguments are those of `render`.
        """
        return self._connection.send("POST", "/v1/canonical", _JSON, body=body(json_bytes(scene), arrays)).content

    def keep(self, scene: Scene, *, arrays: Arrays | None = None) -> str:
        """Have the service keep a scene's quadrics, for renders from many cameras.

        Args:
            scene: a document, which needs no camera.
            arrays: as for `render`.
        Returns:
            The id that a document gives as `scene` in place of `quadrics`. The same quadrics always have the same id.
            A render with an id that is not kept any more raises ProblemError with the code `unknown-scene`.
        """
        answer = self._connection.send("POST", "/v1/scenes", _JSON, body=body(json_bytes(scene), arrays)).json()
        return str(answer["id"])

    def device(self) -> dict[str, Any]:
        """What the service renders with: platform, device, limits, version."""
        answer: dict[str, Any] = self._connection.send("GET", "/v1/device", _JSON).json()
        return answer

    def submit(
        self,
        scene: Scene,
        *,
        arrays: Arrays | None = None,
        idempotency_key: str | None = None,
        priority: Literal["normal", "high"] = "normal",
    ) -> Job:
        """Have the service render a scene with one camera or many while nobody waits.

        Args:
            scene: a document with `camera` or `cameras`; frame k is `cameras[k]`.
            arrays: as for `render`.
            idempotency_key: 1 to 255 visible ASCII characters; the same key and scene again give the same job.
                One is made up if none is given, so that a lost answer makes no second job.
            priority: `high` comes before your other jobs.
        Returns:
            The job, which is on the service's disk.
        """
        key = secrets.token_urlsafe(24) if idempotency_key is None else idempotency_key
        if not _IDEMPOTENCY_KEY.fullmatch(key):
            raise ClientError("the idempotency key is not 1 to 255 visible ASCII characters; a UUID will do")
        sent = body(json_bytes(scene), arrays)
        query: dict[str, str | int] = {} if priority == "normal" else {"priority": priority}
        return Job.read(self._json("POST", "/v1/jobs", sent=sent, headers={"Idempotency-Key": key}, query=query))

    def jobs(self, state: str | None = None) -> Iterator[Job]:
        """Your jobs, newest first, page by page; with `state`, those in it."""
        query: dict[str, str | int] = {} if state is None else {"state": state}
        for page in self._pages("/v1/jobs", query):
            yield from map(Job.read, _list(page, "jobs"))

    def job(self, job_id: str) -> Job:
        """The job as it is now; ProblemError `unknown-job` when there is none, or not any more."""
        return Job.read(self._json("GET", _path(job_id), query={"frame_limit": 0}))

    def frames(self, job_id: str) -> Iterator[Frame]:
        """The job's frames by number, as they are now, page by page."""
        for page in self._pages(_path(job_id), {}):
            yield from map(Frame.read, _list(page, "frames"))

    @overload
    def frame(self, job_id: str, number: int) -> Rendering: ...

    @overload
    def frame(self, job_id: str, number: int, *, etag: str) -> Rendering | None: ...

    def frame(self, job_id: str, number: int, *, etag: str | None = None) -> Rendering | None:
        """The image of a job's frame.

        Args:
            job_id: the job.
            number: the frame, from 0.
            etag: tag of the image that is already here.
        Returns:
            The image; None where `etag` is still its tag.
        Raises:
            ProblemError: `frame-not-ready`, `frame-failed` with the cause, `unknown-job`.
        """
        headers = {} if etag is None else {"If-None-Match": etag}
        response = self._connection.send(
            "GET", f"{_path(job_id)}/frames/{number:d}", _EXR, headers=headers, elsewhere=True
        )
        return None if response.status_code == httpx.codes.NOT_MODIFIED else read_rendering(response)

    def save_frame(self, job_id: str, number: int, file: BinaryIO) -> str | None:
        """Write the image of a job's frame to a file as it comes, whatever its size; else like `frame`.

        Args:
            job_id: the job.
            number: the frame, from 0.
            file: seekable; written from where it stands, again from there when the connection breaks.
        Returns:
            The image's entity tag.
        """
        start = file.tell()
        for again in self._connection.tries():
            with again, self._connection.stream(f"{_path(job_id)}/frames/{number:d}", _EXR, elsewhere=True) as response:
                file.seek(start)
                file.truncate()
                file.writelines(response.iter_bytes())
                tag = tag_of(response)
        return tag

    def events(self, job_id: str, last_event_id: str | None = None) -> Iterator[Event]:
        """What happens to a job, from its first frame to end: each frame that ends is told of once.

        A connection that ends is made again and goes on where it was; how long a service that is away is waited for
        is the client's `patience_s`.

        Args:
            job_id: the job.
            last_event_id: `id` of the last `FrameEnded` that is known already.
        Raises:
            ClientError: what comes are not a job's events.
        """
        return event_streams.follow(self._connection, f"{_path(job_id)}/events", last_event_id, self._patience_s)

    def wait(self, job_id: str) -> Job:
        """The job once it has ended, however."""
        for event in self.events(job_id):
            if isinstance(event, JobEnded):
                return event.job
        return self.job(job_id)

    def cancel(self, job_id: str) -> Job:
        """Cancel a job; the frames that are done stay until it expires. One that has ended stays as it is."""
        return Job.read(self._json("DELETE", _path(job_id)))

    def close(self) -> None:
        """Let go of the connection, and of the transport that was given."""
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _json(
        self,
        method: str,
        path: str,
        *,
        sent: Body | None = None,
        headers: Mapping[str, str] | None = None,
        query: Mapping[str, str | int] | None = None,
    ) -> Any:
        response = self._connection.send(method, path, _JSON, body=sent, headers=headers, query=query)
        try:
            return response.json()
        except ValueError:
            raise ClientError(f"the answer from {self._connection.address} is not JSON") from None

    def _pages(self, path: str, query: dict[str, str | int]) -> Iterator[dict[str, Any]]:
        """Page after page; of the link to the next one only the query is taken, so that it cannot lead elsewhere."""
        seen: list[dict[str, str | int]] = []
        while query not in seen:
            seen.append(query)
            page = self._json("GET", path, query=query)
            if not isinstance(page, dict):
                break
            yield page
            if not isinstance(page.get("next"), str):
                return
            query = dict(parse_qsl(urlsplit(page["next"]).query))
        raise ClientError(f"the answer from {self._connection.address} is not a list of pages")


def _path(job_id: str) -> str:
    return f"/v1/jobs/{checked_id(job_id)}"


def _list(page: Mapping[str, Any], name: str) -> list[Any]:
    found = page.get(name)
    if not isinstance(found, list):
        raise ClientError(f"the service's answer has no list of {name}; is this a Conicoid service?")
    return found
