"""A job of a hundred frames for a farm, followed while things happen to it."""

import hashlib
import json
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Self

import httpx
import psycopg

from tests.checkout import ROOT
from tests.farm.processes import until

FRAMES = 100
_ENDED = ("succeeded", "failed", "cancelled")


def batch(**changes: Any) -> dict[str, Any]:
    """The example of all shapes, seen by cameras that each look a little further; `changes` to each camera."""
    document: dict[str, Any] = json.loads((ROOT / "examples/shapes.json").read_text("utf-8"))
    camera = {**document.pop("camera"), "width": 400, "height": 240, **changes}
    return document | {"cameras": [{**camera, "far": 1000.0 + k} for k in range(FRAMES)]}


@dataclass(frozen=True)
class Recovery:
    """Seconds from the end of a disturbance to the next frame that ended, and to the end of the job."""

    next_frame_s: float
    job_s: float


class Job:
    """A submitted batch; an API that is away meanwhile is asked again."""

    def __init__(self, url: str, document: dict[str, Any]) -> None:
        self._client = httpx.Client(base_url=url, timeout=60)
        response = self._client.post("/v1/jobs", json=document)
        assert response.status_code == 202, response.text
        self.id, self._href = response.json()["id"], response.json()["href"]
        self._last: dict[str, Any] = response.json()

    def now(self) -> dict[str, Any]:
        """The job as the API tells of it, or last told where it does not."""
        with suppress(httpx.TransportError):
            response = self._client.get(f"{self._href}?frame_limit=0", timeout=5)
            if response.status_code == 200:
                self._last = response.json()
        return self._last

    def ended(self) -> int:
        """How many frames have ended."""
        now = self.now()
        return int(now["frames_done"]) + int(now["frames_failed"])

    def wait_for(self, frames: int) -> None:
        """Wait until so many frames have ended."""
        until(lambda: self.ended() >= frames, f"{frames} frames of the job", 120)

    def over(self) -> bool:
        """Whether it has ended."""
        return self.now()["state"] in _ENDED

    def recovery(self, disturb: Callable[[], None], after: int) -> Recovery:
        """What a disturbance costs that begins when some frames have ended; the job has ended then."""
        self.wait_for(after)
        disturb()
        start, ended = time.monotonic(), self.ended()
        until(lambda: self.ended() > ended or ended == FRAMES, "the next frame", 120)
        next_frame_s = time.monotonic() - start
        until(self.over, "the job's end", 120)
        return Recovery(round(next_frame_s, 2), round(time.monotonic() - start, 2))

    def frames(self) -> list[dict[str, Any]]:
        """All frames as the API tells of them."""
        found: list[dict[str, Any]] = self._client.get(f"{self._href}?frame_limit={FRAMES}").json()["frames"]
        return found

    def told(self) -> list[int]:
        """The frames that the stream of events tells of, in its order."""
        lines = self._client.get(f"{self._href}/events").text.splitlines()
        return [json.loads(line.removeprefix("data: "))["frame"] for line in lines if '"frame":' in line]

    def digests(self) -> list[str]:
        """SHA-256 of every frame's image."""
        found = []
        for k in range(FRAMES):
            response = self._client.get(f"{self._href}/frames/{k}")
            assert response.status_code == 200, response.text
            found.append(hashlib.sha256(response.content).hexdigest())
        return found

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()


def order_of_ends(database_url: str, job_id: str) -> list[int | None]:
    """As the how many-th each frame has ended, from 1, in the order of frames."""
    query = "SELECT ended_as FROM frames WHERE job_id = %s AND band = 0 ORDER BY number"
    with psycopg.connect(database_url) as connection:
        return [row[0] for row in connection.execute(query, [job_id])]
