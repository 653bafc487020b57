"""Where the watched metrics come from: the only place that knows both sides."""

from collections import Counter
from collections.abc import Mapping

from starlette.datastructures import State

from conicoid_service.images import Images
from conicoid_service.line import Waiting
from conicoid_service.pool import Pool
from conicoid_service.settings import Settings
from conicoid_service.telemetry.watched import Readers, Readings


def watch(readers: Readers, state: State) -> None:
    """Register all that an application's state has; `state.jobs` is None where, or while, there is no job store."""
    settings: Settings = state.settings
    images: Images = state.gallery.images
    children: Mapping[str, Pool] = state.pipeline.children
    render = children["render"]
    readers.watch("conicoid_processes", lambda: {name: float(child.counts().alive) for name, child in children.items()})
    readers.watch("conicoid_queue_requests", lambda: _by_class(render.counts().waiting, "{}"))
    readers.watch("conicoid_queue_oldest_seconds", lambda: _by_class(render.counts().waiting, "{}_age_s"))
    readers.watch("conicoid_queue_limit", lambda: {"": settings.queue_length})
    readers.watch("conicoid_document_queue_requests", lambda: {"": children["document"].waiting})
    readers.watch("conicoid_losses", lambda: sum((child.losses for child in children.values()), Counter[str]()))
    readers.watch("conicoid_retries", lambda: {"": sum(child.retries for child in children.values())})
    readers.watch("conicoid_images_kept_bytes", lambda: {"": images.size})
    readers.watch("conicoid_store_limit_bytes", lambda: {"": settings.store_limit} if state.jobs else {})
    readers.watch("conicoid_frames_ended", lambda: state.jobs.frames_ended if state.jobs else {})

    async def counted(what: str) -> Readings:
        counts: Readings = await state.jobs.counts(what) if state.jobs else {}
        return counts

    async def units_sent() -> Readings:
        sent: Readings = await state.jobs.units_sent() if state.jobs else {}
        return sent

    readers.watch("conicoid_units_sent", units_sent)
    readers.watch("conicoid_jobs", lambda: counted("jobs"))
    readers.watch("conicoid_frames", lambda: counted("frames"))
    readers.watch("conicoid_store_bytes", lambda: counted("bytes"))


def _by_class(waiting: Waiting, name: str) -> dict[str, float]:
    return {each: float(getattr(waiting, name.format(each))) for each in ("interactive", "batch")}
