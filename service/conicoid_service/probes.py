"""What a load balancer, an orchestrator or a monitoring system asks."""

from typing import Any

from fastapi import APIRouter, Request, Response

from conicoid_service.openapi import METRICS_DOCS, READY_DOCS
from conicoid_service.problems import problem
from conicoid_service.telemetry.metrics import CONTENT_TYPE

router = APIRouter(tags=["probes"])


@router.get("/livez")
async def livez() -> dict[str, str]:
    """Answered as long as the event loop runs; depends on nothing else."""
    return {"status": "alive"}


@router.get("/readyz", response_model=None, **READY_DOCS)
async def readyz(request: Request) -> dict[str, Any] | Response:
    """200 when a request that comes now would be answered: `checks` says `ok` of everything that this needs.

    Both child processes are alive and warm, the queue has room, the disk takes a small file, the service is not about
    to end. Else a problem document whose `checks` say why not; requests are accepted even so, and wait or are refused.
    """
    found = await request.app.state.readiness.checks()
    checks = {name: "ok" if error is None else str(error) for name, error in found.items()}
    for error in found.values():
        if error is not None:
            return problem(error, status=503, checks=checks)
    return {"status": "ready", "checks": checks}


@router.get("/metrics", response_class=Response, **METRICS_DOCS)
async def metrics(request: Request) -> Response:
    """Prometheus metrics; docs/operations.md lists them."""
    return Response(await request.app.state.metrics.text(), media_type=CONTENT_TYPE)
