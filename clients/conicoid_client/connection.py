"""One HTTP connection to a service: its key, its errors, and when a request is sent again.

Every request of this client may be sent again without harm: reading, rendering and cancelling change nothing the second
time, and a job is submitted with an `Idempotency-Key`.
"""

import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import httpx

from conicoid_client.bodies import Body
from conicoid_client.errors import ClientError, Problem, ProblemError, SceneRejected, ServerBusy, Unreachable

_REJECTED = frozenset({400, 413, 415, 422})
_LONGEST_WAIT_S = 60.0
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 0.25, 8.0
_KEY = re.compile(r"[\x21-\x7e]+")


class Connection:
    """What `Client` sends its requests through; the arguments are those of `Client`."""

    def __init__(
        self,
        base_url: str,
        *,
        api_key: str | None,
        transport: httpx.BaseTransport | None,
        timeout_s: float,
        retries: int,
        patience_s: float,
    ) -> None:
        self._retries, self._patience_s = retries, patience_s
        try:
            url = httpx.URL(base_url)
        except httpx.InvalidURL as error:
            raise ClientError(f"{base_url!r} is not a URL ({error}); give one like http://127.0.0.1:8000") from None
        if url.scheme not in ("http", "https") or not url.host:
            raise ClientError(f"{base_url!r} is not an http(s) URL; give one like http://127.0.0.1:8000")
        if api_key is not None and not _KEY.fullmatch(api_key):
            raise ClientError("the API key is not of visible ASCII characters; give it as it was given to you")
        authorization = {} if api_key is None else {"Authorization": f"Bearer {api_key}"}
        self.address = str(url.copy_with(userinfo=b""))
        # Paths are made here and never taken from an answer, and no redirect is followed but to an image, which may be
        # in an object store: httpx gives the key to nobody at another origin.
        self._http = httpx.Client(
            base_url=url,
            transport=transport,
            timeout=httpx.Timeout(timeout_s, connect=min(10.0, timeout_s)),
            headers={"User-Agent": "conicoid-client", **authorization},
            follow_redirects=False,
        )

    def close(self) -> None:
        """Let go of the connection, and of the transport that was given."""
        self._http.close()

    def send(
        self,
        method: str,
        path: str,
        media_type: str,
        *,
        body: Body | None = None,
        headers: Mapping[str, str] | None = None,
        query: Mapping[str, str | int] | None = None,
        elsewhere: bool = False,
    ) -> httpx.Response:
        """One request, repeated where that may help; the answer is of `media_type`, or a bare 304.

        It may come from somewhere `elsewhere`.

        Raises:
            Unreachable, ProblemError: as `Client` says.
        """
        headers = {**(headers or {}), **({"Content-Type": "application/json"} if isinstance(body, bytes) else {})}
        sent: dict[str, Any] = {"content": body} if isinstance(body, bytes) else {"files": body}
        if query is not None:
            sent["params"] = query
        for again in self.tries():
            with again:
                response = self._http.request(method, path, headers=headers, follow_redirects=elsewhere, **sent)
                self.check(response, media_type)
        return response

    @contextmanager
    def stream(
        self,
        path: str,
        media_type: str,
        *,
        headers: Mapping[str, str] | None = None,
        silence_s: float | None = None,
        elsewhere: bool = False,
    ) -> Iterator[httpx.Response]:
        """The answer to a GET, once, of which the body is still to be read; reading may raise httpx.HTTPError.

        Args:
            path: where.
            media_type: what the answer is; a bare 204 or 304 is one too.
            headers: of the request.
            silence_s: longest wait for the next bytes, in place of the client's timeout.
            elsewhere: whether the answer may come from another server.
        """
        timeout = self._http.timeout if silence_s is None else httpx.Timeout(silence_s, connect=min(10.0, silence_s))
        following = self._http.stream("GET", path, headers=headers, timeout=timeout, follow_redirects=elsewhere)
        with following as response:
            if not response.is_success:
                response.read()
            self.check(response, media_type)
            yield response

    def tries(self) -> "Iterator[Try]":
        """What to do in `with again:`, as often as it fails in a way that another attempt may mend."""
        attempt, pauses, waited_s = 0, pause_lengths(), 0.0
        while True:
            again = Try(self.address)
            yield again
            if again.done:
                return
            if again.wait_s is not None:
                attempt += 1
                if again.wait_s > _LONGEST_WAIT_S or attempt > self._retries:
                    raise again.error
                time.sleep(again.wait_s)
                continue
            pause_s = next(pauses)
            waited_s += pause_s
            if waited_s > self._patience_s:
                raise again.error
            time.sleep(pause_s)

    def check(self, response: httpx.Response, media_type: str) -> None:
        """Raise what an answer says that is an error, or that is not of `media_type`."""
        if response.status_code in (httpx.codes.NOT_MODIFIED, httpx.codes.NO_CONTENT):
            return
        if not response.is_success:
            raise _problem(response)
        if not response.history and response.headers.get("Content-Type", "").partition(";")[0] != media_type:
            detail = f"the answer from {self.address} is not {media_type}; is this a Conicoid service?"
            raise ProblemError(response.status_code, "http-media-type", detail)


class Try:
    """One attempt; as a context manager it keeps an error that another attempt may mend, and passes on the others.

    Attributes:
        done: it succeeded.
        error: what went wrong.
        wait_s: seconds that the service asked to wait; None where there was no answer at all.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self.done = False
        self.error: ClientError = Unreachable(f"no answer from {address}")
        self.wait_s: float | None = None

    def __enter__(self) -> None:
        pass

    def __exit__(self, _kind: type[BaseException] | None, error: BaseException | None, _trace: object) -> bool:
        if error is None:
            self.done = True
            return False
        if isinstance(error, ServerBusy):
            self.error, self.wait_s = error, error.retry_after
            return error.retry_after is not None
        if isinstance(error, httpx.HTTPError):
            self.error = Unreachable(f"no answer from {self._address}: {str(error) or type(error).__name__}")
            self.error.__cause__ = error
            if isinstance(error, httpx.TimeoutException) and not isinstance(error, httpx.ConnectTimeout):
                raise self.error  # it had its time, and would take the same again
            return True
        return False


def pause_lengths() -> Iterator[float]:
    """Seconds between attempts to reach a service that does not answer."""
    pause_s = _FIRST_PAUSE_S
    while True:
        yield pause_s
        pause_s = min(2 * pause_s, _LONGEST_PAUSE_S)


def _retry_after(response: httpx.Response) -> float | None:
    """Seconds to wait before the same request may succeed; None where the service promises nothing."""
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
