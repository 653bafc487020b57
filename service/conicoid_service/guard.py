"""The outermost layer: security headers on every response, and a problem document for what nothing else caught."""

import logging
from asyncio import CancelledError

from starlette.datastructures import MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from conicoid_service.errors import StoppingError
from conicoid_service.problems import internal_problem, problem

# What is sent is data: nothing in it is to be run, framed, guessed at, or taken for a shared cache's.
HEADERS = {
    "Cache-Control": "private, no-cache",
    "Content-Security-Policy": "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}

logger = logging.getLogger(__name__)


class Guard:
    """ASGI middleware around everything."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        started = False

        async def send_guarded(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        try:
            await self._app(scope, receive, send_guarded)
        except CancelledError:
            if not started:  # the server has waited as long as it may
                await problem(StoppingError("the service is shutting down; ask another"))(scope, receive, send_guarded)
            raise
        except ClientDisconnect:
            logger.info("a client went away")
        except Exception:
            logger.exception("a request failed in a way that is a defect")
            if started:
                raise  # the server cuts the connection, so that the client does not take the part for the whole
            await internal_problem()(scope, receive, send_guarded)
