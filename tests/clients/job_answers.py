"""What a service answers about jobs, made up here."""

import json
from collections.abc import Iterable, Iterator
from typing import Any

import httpx

ID = "01a21469fd4ab9f497df6028e48d"


def job(state: str = "running", done: int = 0, failed: int = 0, total: int = 3, job_id: str = ID) -> dict[str, Any]:
    ended = state in ("succeeded", "failed", "cancelled")
    return {
        "id": job_id,
        "state": state,
        "created": "2026-01-01T00:00:00.000Z",
        "started": None if state == "queued" else "2026-01-01T00:00:01.000Z",
        "finished": "2026-01-01T00:00:02.500Z" if ended else None,
        "expires": "2026-01-08T00:00:02.500Z" if ended else None,
        "frames_total": total,
        "frames_done": done,
        "frames_failed": failed,
        "href": f"/v1/jobs/{job_id}",
        "events": f"/v1/jobs/{job_id}/events",
    }


def frame(number: int, error: str | None = None) -> dict[str, Any]:
    return {
        "frame": number,
        "state": "failed" if error else "succeeded",
        "href": f"/v1/jobs/{ID}/frames/{number}",
        "etag": None if error else f'"tag-{number}"',
        "bytes": None if error else len(image(number)),
        "error": {"code": "render-crashed", "detail": error} if error else None,
    }


def image(number: int) -> bytes:
    return f"image {number}".encode() * 1000


def event(name: str, data: object, event_id: str | None = None) -> bytes:
    lines = [f"event: {name}", f"data: {json.dumps(data)}", *([] if event_id is None else [f"id: {event_id}"])]
    return "\n".join(lines).encode() + b"\n\n"


def frame_event(nth: int, number: int, failed: int = 0, total: int = 3, error: str | None = None) -> bytes:
    counts = {"frames_done": nth - failed, "frames_failed": failed, "frames_total": total}
    return event("frame", frame(number, error) | counts, str(nth))


def events(*sent: bytes, cut: bool = False) -> httpx.Response:
    """A stream of events; `cut` ends it as a broken connection does."""
    return httpx.Response(200, headers={"Content-Type": "text/event-stream"}, stream=Pieces(sent, cut))


def answer(data: object, status: int = 200) -> httpx.Response:
    return httpx.Response(status, headers={"Content-Type": "application/json"}, content=json.dumps(data))


class Pieces(httpx.SyncByteStream):
    def __init__(self, pieces: Iterable[bytes], cut: bool = False) -> None:
        self._pieces, self._cut = pieces, cut

    def __iter__(self) -> Iterator[bytes]:
        yield from self._pieces
        if self._cut:
            raise httpx.RemoteProtocolError("peer closed connection")
