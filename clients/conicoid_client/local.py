"""The service in this process: the same application, reached without a port."""

from contextlib import ExitStack
from typing import TYPE_CHECKING

import httpx
from anyio.from_thread import start_blocking_portal

if TYPE_CHECKING:
    from fastapi import FastAPI


class LocalTransport(httpx.BaseTransport):
    """Answers an `httpx.Client` from an ASGI application that runs in a thread of its own.

    The application's lifespan is entered on construction and left by close(), so its render process starts and
    ends with this object.
    """

    def __init__(self, app: "FastAPI") -> None:
        self._asgi = httpx.ASGITransport(app, raise_app_exceptions=False)
        with ExitStack() as stack:
            self._portal = stack.enter_context(start_blocking_portal())
            stack.enter_context(self._portal.wrap_async_context_manager(app.router.lifespan_context(app)))
            self._running = stack.pop_all()

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """One request, answered by the application's thread."""
        return self._portal.call(self._answer, request)

    def close(self) -> None:
        """Leave the application's lifespan and end its thread."""
        self._running.close()

    async def _answer(self, request: httpx.Request) -> httpx.Response:
        response = await self._asgi.handle_async_request(request)
        body = await response.aread()
        return httpx.Response(
            response.status_code, headers=response.headers, content=body, extensions=response.extensions
        )
