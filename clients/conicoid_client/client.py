"""Talking to a Conicoid service over HTTP, or to one in this process."""

import io
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self, overload
from zipfile import ZipFile

import httpx

from conicoid_client.errors import ClientError, Problem, ProblemError, SceneRejected, ServerBusy, Unreachable
from conicoid_client.precision import with_precision

Scene = bytes | Mapping[str, Any]
Arrays = bytes | Mapping[str, Any]
Body = bytes | Mapping[str, tuple[str | None, bytes, str]]  # JSON, or the parts of multipart/form-data

_REJECTED = frozenset({400, 413, 415, 422})
_LONGEST_WAIT_S = 60.0


@dataclass(frozen=True)
class Rendering:
    """One rendered view.

    Attributes:
        exr: the OpenEXR file.
        etag: strong entity tag: the same scene rendered by the same build has the same tag.
        timing_ms: the service's own account (queue, parse, setup, cast, encode), milliseconds.
        settled: pixels that were settled in exact arithmetic on the host; None where the service did not say.
    """

    exr: bytes
    etag: str | None
    timing_ms: dict[str, float]
    settled: int | None


class Client:
    """A connection to a Conicoid service; use it as a context manager, or close() it.

    Args:
        base_url: the service's address, as in `http://127.0.0.1:8000`.
        transport: another way to reach it, such as `conicoid_client.local.LocalTransport`.
        timeout_s: longest wait for the answer to one request; connecting takes at most 10 s of it.
        retries: how often a request is repeated that the service answered with 429 or 503 and a `Retry-After`;
            without the header there is nothing to wait for, and the error is raised at once.

    Raises:
        Unreachable: from every call, when there is no answer.
        ProblemError: from every call, when the answer is an error; `SceneRejected` and `ServerBusy` are kinds of it.
    """

    def __init__(
        self,
        base_url: str = "http://127.0.0.1:8000",
        *,
        transport: httpx.BaseTransport | None = None,
        timeout_s: float = 600.0,
        retries: int = 4,
    ) -> None:
        self._retries = retries
        try:
            url = httpx.URL(base_url)
        except httpx.InvalidURL as error:
            raise ClientError(f"{base_url!r} is not a URL ({error}); give one like http://127.0.0.1:8000") from None
        if url.scheme not in ("http", "https") or not url.host:
            raise ClientError(f"{base_url!r} is not an http(s) URL; give one like http://127.0.0.1:8000")
        self._http = httpx.Client(
            base_url=url,
            transport=transport,
            timeout=httpx.Timeout(timeout_s, connect=min(10.0, timeout_s)),
            headers={"User-Agent": "conicoid-client"},
        )

    @overload
    def render(self, scene: Scene, *, arrays: Arrays | None = None, precision: str | None = None) -> Rendering: ...

    @overload
    def render(
        self, scene: Scene, *, arrays: Arrays | None = None, precision: str | None = None, etag: str
    ) -> Rendering | None: ...

    def render(
        self, scene: Scene, *, arrays: Arrays | None = None, precision: str | None = None, etag: str | None = None
    ) -> Rendering | None:
        """Render a scene with one camera.

        Args:
            scene: the document as JSON text, sent as it is, or as a mapping.
            arrays: what the document's sets name as `"@name"`: by name, or as the bytes of an `.npz` file.
            precision: `exact`, `float64` or `float32` in place of the document's `output.precision`.
            etag: tag of the rendering that is already here.
        Returns:
            The rendering; None where `etag` is still its tag.
        """
        body = _json(scene)
        if precision is not None:
            body = with_precision(body, precision)
        headers = {} if etag is None else {"If-None-Match": etag}
        response = self._send("POST", "/v1/render", "image/x-exr", body=_body(body, arrays), headers=headers)
        if response.status_code == httpx.codes.NOT_MODIFIED:
            return None
        settled = response.headers.get("Conicoid-Settled", "")
        return Rendering(
            exr=response.content,
            etag=response.headers.get("ETag"),
            timing_ms=_timing(response.headers.get("Server-Timing", "")),
            settled=int(settled) if settled.isdecimal() else None,
        )

    def canonical(self, scene: Scene, *, arrays: Arrays | None = None) -> bytes:
        """The scene's canonical form: everything resolved, every default filled in, as JSON text.

        It needs no arrays any more. The arguments are those of `render`.
        """
        return self._send("POST", "/v1/canonical", "application/json", body=_body(_json(scene), arrays)).content

    def keep(self, scene: Scene, *, arrays: Arrays | None = None) -> str:
        """Have the service keep a scene's quadrics, for renders from many cameras.

        Args:
            scene: a document, which needs no camera.
            arrays: as for `render`.
        Returns:
            The id that a document gives as `scene` in place of `quadrics`. The same quadrics always have the same id.
            A render with an id that is not kept any more raises ProblemError with the code `unknown-scene`.
        """
        answer = self._send("POST", "/v1/scenes", "application/json", body=_body(_json(scene), arrays)).json()
        return str(answer["id"])

    def device(self) -> dict[str, Any]:
        """What the service renders with: platform, device, limits, version."""
        answer: dict[str, Any] = self._send("GET", "/v1/device", "application/json").json()
        return answer

    def close(self) -> None:
        """Let go of the connection, and of the transport that was given."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(
        self,
        method: str,
        path: str,
        media_type: str,
        *,
        body: Body | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> httpx.Response:
        """One request, repeated while the service asks for that; the answer is of `media_type`, or a bare 304."""
        headers = {**(headers or {}), **({"Content-Type": "application/json"} if isinstance(body, bytes) else {})}
        sent: dict[str, Any] = {"content": body} if isinstance(body, bytes) else {"files": body}
        for attempt in range(self._retries + 1):
            try:
                response = self._http.request(method, path, headers=headers, **sent)
            except httpx.HTTPError as error:
                reason = str(error) or type(error).__name__
                raise Unreachable(f"no answer from {self._http.base_url}: {reason}") from error
            wait_s = _retry_after(response)
            if wait_s is None or wait_s > _LONGEST_WAIT_S or attempt == self._retries:
                break
            time.sleep(wait_s)
        if not response.is_success and response.status_code != httpx.codes.NOT_MODIFIED:
            raise _problem(response)
        if response.is_success and response.headers.get("Content-Type", "").partition(";")[0] != media_type:
            detail = f"the answer from {self._http.base_url} is not {media_type}; is this a Conicoid service?"
            raise ProblemError(response.status_code, "http-media-type", detail)
        return response


def _json(scene: Scene) -> bytes:
    if isinstance(scene, bytes):
        return scene
    return json.dumps(scene, allow_nan=False, separators=(",", ":")).encode()


def _body(scene: bytes, arrays: Arrays | None) -> Body:
    if arrays is None:
        return scene
    npz = arrays if isinstance(arrays, bytes) else _npz(arrays)
    return {
        "scene": (None, scene, "application/json"),
        "arrays": ("arrays.npz", npz, "application/octet-stream"),
    }


def _npz(arrays: Mapping[str, Any]) -> bytes:
    """What `numpy.savez` would write, which cannot take every name.

    Raises:
        ValueError: an array holds Python objects.
    """
    import numpy as np

    file = io.BytesIO()
    with ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asanyarray(array), allow_pickle=False)
    return file.getvalue()


def _retry_after(response: httpx.Response) -> float | None:
    """Seconds to wait before the same request may succeed; None where the service promises nothing."""
    if response.status_code not in (httpx.codes.TOO_MANY_REQUESTS, httpx.codes.SERVICE_UNAVAILABLE):
        return None
    try:
        return max(0.0, float(response.headers["Retry-After"]))
    except (KeyError, ValueError):
        return None


def _problem(response: httpx.Response) -> ProblemError:
    status = response.status_code
    try:
        body = response.json()
    except ValueError:
        body = None
    if not isinstance(body, dict):
        body = {}
    detail = str(body.get("detail") or body.get("title") or f"{status} {response.reason_phrase}")
    code = str(body.get("code") or f"http-{status}")
    errors = body.get("errors")
    problems = [
        Problem(str(e.get("pointer", "")), str(e.get("message", "")), str(e.get("code", "")))
        for e in (errors if isinstance(errors, list) else [])
        if isinstance(e, dict)
    ]
    if status in (httpx.codes.TOO_MANY_REQUESTS, httpx.codes.SERVICE_UNAVAILABLE):
        return ServerBusy(status, code, detail, problems, _retry_after(response))
    return (SceneRejected if status in _REJECTED else ProblemError)(status, code, detail, problems)


def _timing(header: str) -> dict[str, float]:
    """`Server-Timing: cast;dur=4.1, encode;dur=97.0` as {"cast": 4.1, "encode": 97.0}."""
    times: dict[str, float] = {}
    for entry in header.split(","):
        name, *parameters = (part.strip() for part in entry.split(";"))
        for parameter in parameters:
            key, _, value = parameter.partition("=")
            if key == "dur":
                try:
                    times[name] = float(value)
                except ValueError:
                    continue
    return times
