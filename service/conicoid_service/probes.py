"""What a load balancer or an orchestrator asks."""

from fastapi import APIRouter, Request

from conicoid_service.openapi import READY_DOCS

router = APIRouter(tags=["probes"])


@router.get("/livez")
async def livez() -> dict[str, str]:
    """Answered as long as the event loop runs; depends on nothing else."""
    return {"status": "alive"}


@router.get("/readyz", **READY_DOCS)
async def readyz(request: Request) -> dict[str, str]:
    """200 when both processes are alive and warm; before that requests are accepted, and wait."""
    request.app.state.pipeline.check_ready()
    return {"status": "ready"}
