"""Jobs and frames as JSON."""

from datetime import UTC, datetime
from typing import Any

from conicoid_service.jobs.records import PRIORITIES, Frame, Job


def job_document(job: Job) -> dict[str, Any]:
    """What a client is told about a job."""
    href = f"/v1/jobs/{job.id}"
    return {
        "id": job.id,
        "state": job.state,
        "priority": next(name for name, urgency in PRIORITIES.items() if urgency == job.priority),
        "created": _time(job.created_ms),
        "started": _time(job.started_ms),
        "finished": _time(job.finished_ms),
        "expires": _time(job.expires_ms),
        "frames_total": job.frames_total,
        "frames_done": job.frames_done,
        "frames_failed": job.frames_failed,
        "href": href,
        "events": f"{href}/events",
    }


def frame_document(frame: Frame) -> dict[str, Any]:
    """What a client is told about a frame."""
    return {
        "frame": frame.number,
        "state": frame.state,
        "href": f"/v1/jobs/{frame.job_id}/frames/{frame.number}",
        "etag": None if frame.tag is None else f'"{frame.tag}"',
        "bytes": frame.bytes,
        "error": None if frame.error_code is None else {"code": frame.error_code, "detail": frame.error_detail},
    }


def _time(ms: int | None) -> str | None:
    """Milliseconds since 1970 as RFC 3339, UTC."""
    if ms is None:
        return None
    return datetime.fromtimestamp(ms / 1e3, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
