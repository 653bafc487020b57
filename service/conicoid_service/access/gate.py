"""The gate before the routes: whose request it is, and whether its owner has too many already."""

from collections import Counter
from typing import Final

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from conicoid_service.access.keys import Keys
from conicoid_service.errors import QuotaError, ServiceError, UnauthorizedError
from conicoid_service.problems import problem

OPEN: Final = frozenset({"/livez", "/readyz", "/metrics"})


class Gate:
    """ASGI middleware that sets `request.state.owner`, or refuses before a byte of the body is read.

    The owner is "" where no keys are set, and on the routes that need none.
    """

    def __init__(self, app: ASGIApp, keys: Keys, owner_requests: int) -> None:
        """Let requests with one of `keys` in, `owner_requests` of each owner at a time."""
        self._app, self._keys, self._most = app, keys, owner_requests
        self._under_way: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        state = scope.setdefault("state", {})
        state["owner"] = ""
        if not self._keys or scope["path"] in OPEN:
            await self._app(scope, receive, send)
            return
        try:
            owner = state["owner"] = self._owner(Headers(scope=scope))
        except ServiceError as error:
            await problem(error)(scope, receive, send)
            return
        self._under_way[owner] += 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._under_way[owner] -= 1

    def _owner(self, headers: Headers) -> str:
        given = headers.getlist("authorization")
        scheme, _, key = given[0].partition(" ") if len(given) == 1 else ("", "", "")
        owner = self._keys.owner_of(key.strip().encode("latin-1")) if scheme.lower() == "bearer" else None
        if owner is None:
            raise UnauthorizedError("the request has no API key of this service; send `Authorization: Bearer KEY`")
        if self._under_way[owner] >= self._most:
            raise QuotaError(
                f"{self._under_way[owner]} requests of this API key are under way, it may have {self._most}; "
                "wait until one is answered"
            )
        return owner
