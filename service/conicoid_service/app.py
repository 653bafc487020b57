"""The HTTP application.

Run it with `conicoid serve`, or under any ASGI server: `uvicorn --factory conicoid_service.app:create_app`.
"""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache, partial
from typing import cast

from fastapi import FastAPI, Request, Response
from starlette.exceptions import HTTPException

from conicoid import __version__
from conicoid.errors import ConicoidError
from conicoid_service import docs_page, probes, routes
from conicoid_service.access.gate import Gate
from conicoid_service.access.origins import Origins
from conicoid_service.guard import Guard
from conicoid_service.openapi import describe
from conicoid_service.pipeline import Pipeline
from conicoid_service.problems import http_problem, problem
from conicoid_service.settings import Settings

DESCRIPTION = "Exact batch ray-casting of quadrics: scene documents in, OpenEXR depth and normals out."


def create_app(settings: Settings | None = None, pipeline: Pipeline | None = None) -> FastAPI:
    """The application; its lifespan starts and ends the child processes.

    Args:
        settings: None reads them from the environment.
        pipeline: of the same settings, perhaps started already; None makes one.
    Raises:
        SettingsError: the environment's settings are unusable.
    """
    settings = settings or Settings.from_environment()
    running = pipeline or Pipeline(settings)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        running.start()
        try:
            yield
        finally:
            await running.stop()

    app = FastAPI(
        title="Conicoid",
        version=__version__,
        description=DESCRIPTION,
        lifespan=lifespan,
        redirect_slashes=False,
        docs_url=None,
        redoc_url=None,
    )
    app.state.settings, app.state.pipeline = settings, running
    app.include_router(probes.router)
    app.include_router(routes.router)
    app.include_router(docs_page.router)
    # The last is the outermost: a script asks what it may send before it sends a key.
    app.add_middleware(Gate, settings.api_keys, settings.owner_requests)
    if settings.cors_origins:
        app.add_middleware(Origins, settings.cors_origins)
    app.add_middleware(Guard)
    app.add_exception_handler(ConicoidError, _refuse)
    app.add_exception_handler(HTTPException, _refuse_http)
    app.openapi = cache(partial(describe, app))  # type: ignore[method-assign]  # FastAPI's documented extension point
    return app


async def _refuse(_: Request, error: Exception) -> Response:
    return problem(cast(ConicoidError, error))


async def _refuse_http(request: Request, error: Exception) -> Response:
    refused = cast(HTTPException, error)
    detail = f"{request.method} {request.url.path[:200]}: {refused.detail}; see /docs for what there is"
    return http_problem(refused.status_code, detail, refused.headers)
