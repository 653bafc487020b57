"""The HTTP application.

Run it with `conicoid serve`, or under any ASGI server: `uvicorn --factory conicoid_service.app:create_app`.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache, partial
from typing import TYPE_CHECKING, cast

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.routing import Match

from conicoid import __version__
from conicoid.errors import ConicoidError
from conicoid_service import docs_page, job_routes, probes, routes
from conicoid_service.access.gate import Gate
from conicoid_service.access.origins import Origins
from conicoid_service.gallery import Gallery
from conicoid_service.guard import Guard
from conicoid_service.images import Images
from conicoid_service.openapi import describe
from conicoid_service.pipeline import Pipeline
from conicoid_service.problems import http_problem, parameter_problem, problem
from conicoid_service.settings import Settings
from conicoid_service.telemetry.observe import observe

if TYPE_CHECKING:
    from conicoid_service.jobs.storage import Storage

ROUTERS = (probes.router, routes.router, job_routes.router, docs_page.router)
DESCRIPTION = "Exact batch ray-casting of quadrics: scene documents in, OpenEXR depth and normals out."


def create_app(
    settings: Settings | None = None,
    pipeline: Pipeline | None = None,
    *,
    storage: "Storage | None" = None,
    keeps_jobs: bool = True,
) -> FastAPI:
    """The application; its lifespan starts and ends the child processes.

    Args:
        settings: None reads them from the environment.
        pipeline: of the same settings, perhaps started already; None makes one.
        storage: the job store, opened; None opens it when the lifespan begins.
        keeps_jobs: whether there is a job store at all.
    Raises:
        SettingsError: the environment's settings are unusable.
        StoreError: the job store cannot be opened; from the lifespan.
    """
    settings = settings or Settings.from_environment()
    running = pipeline or Pipeline(settings)

    images = Images(settings.image_cache_limit)
    gallery = Gallery(running, images)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        running.start()
        try:
            if keeps_jobs:
                await _keep_jobs(app, storage)
            yield
        finally:
            if app.state.jobs is not None:
                await app.state.jobs.stop()
            await running.stop()
            images.close()
            if app.state.traces is not None:
                await asyncio.to_thread(app.state.traces.close)

    app = FastAPI(
        title="Conicoid",
        version=__version__,
        description=DESCRIPTION,
        lifespan=lifespan,
        redirect_slashes=False,
        generate_unique_id_function=lambda route: route.name,
        docs_url=None,
        redoc_url=None,
    )
    app.state.settings, app.state.pipeline, app.state.gallery, app.state.jobs = settings, running, gallery, None
    for router in ROUTERS:
        app.include_router(router)
    # The last is the outermost: a script asks what it may send before it sends a key.
    app.add_middleware(Gate, settings.api_keys, settings.owner_requests)
    if settings.cors_origins:
        app.add_middleware(Origins, settings.cors_origins)
    app.add_middleware(Guard)
    observe(app)
    app.add_exception_handler(ConicoidError, _refuse)
    app.add_exception_handler(HTTPException, _refuse_http)
    app.add_exception_handler(RequestValidationError, _refuse_parameters)
    app.openapi = cache(partial(describe, app))  # type: ignore[method-assign]  # FastAPI's documented extension point
    return app


async def _keep_jobs(app: FastAPI, storage: "Storage | None") -> None:
    """Begin to render what is in the job store."""
    # What it needs takes as long to load as a short render.
    from conicoid_service.jobs.jobs import Jobs
    from conicoid_service.jobs.scene_shelf import SceneShelf
    from conicoid_service.jobs.storage import Storage

    state = app.state
    opened = storage if storage is not None else await asyncio.to_thread(Storage, state.settings)
    state.jobs = Jobs(state.settings, opened, state.pipeline, state.gallery)
    state.gallery.shelf, state.pipeline.kept.shelf = state.jobs, SceneShelf(opened)
    state.jobs.start()


async def _refuse(_: Request, error: Exception) -> Response:
    return problem(cast(ConicoidError, error))


async def _refuse_http(request: Request, error: Exception) -> Response:
    refused = cast(HTTPException, error)
    detail = f"{request.method} {request.url.path[:200]}: {refused.detail}; see /docs for what there is"
    headers = refused.headers
    if refused.status_code == 405:  # Starlette names the methods of the first route of the path alone
        headers = {**(headers or {}), "Allow": ", ".join(sorted(_methods(request)))}
    return http_problem(refused.status_code, detail, headers)


def _methods(request: Request) -> set[str]:
    """The methods of all routes of the request's path."""
    routes_of_all = (route for router in ROUTERS for route in router.routes)
    at = [route for route in routes_of_all if route.matches(request.scope)[0] != Match.NONE]
    return {method for route in at for method in getattr(route, "methods", None) or ()}


async def _refuse_parameters(_: Request, error: Exception) -> Response:
    return parameter_problem(cast(RequestValidationError, error))
