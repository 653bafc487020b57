"""Users of `make load`, for Locust: most want an image now, some a job or the same again, a few make mistakes."""

import json
import random
import time
from pathlib import Path
from typing import Any

from locust import FastHttpUser, constant

_SHAPES = Path(__file__).parents[1] / "examples" / "shapes.json"
JSON = {"Content-Type": "application/json"}


def scene(number: int, width: int = 480, height: int = 270) -> dict[str, Any]:
    """The example of all shapes, with a far plane that makes it another image for each number."""
    document: dict[str, Any] = json.loads(_SHAPES.read_text("utf-8"))
    document["camera"] |= {"width": width, "height": height, "far": 1000.0 + number}
    document["camera"].pop("crop", None)
    return document


class Farmhand(FastHttpUser):  # type: ignore[misc]
    """One client that sends its next request when it has its answer, or when it was refused."""

    wait_time = constant(0)
    network_timeout = 120.0

    def on_start(self) -> None:
        """Numbers of its own."""
        self._random = random.Random(id(self))

    def render(self) -> None:
        """An image that nobody has seen."""
        self._post("/v1/render", scene(self._random.getrandbits(40)), "render")

    def render_again(self) -> None:
        """An image that many want."""
        self._post("/v1/render", scene(self._random.randrange(4)), "render, seen before")

    def canonical(self) -> None:
        """A document that is only read."""
        self._post("/v1/canonical", scene(self._random.getrandbits(40)), "canonical")

    def job(self) -> None:
        """A batch of ten frames, which is left alone."""
        document = scene(0)
        camera = document.pop("camera")
        first = self._random.getrandbits(40)
        document["cameras"] = [{**camera, "far": 2000.0 + first + k} for k in range(10)]
        self._post("/v1/jobs", document, "job")

    def mistake(self) -> None:
        """A document with a mistake."""
        document = scene(0)
        document["camera"]["width"] = -1
        self._post("/v1/render", document, "mistake", expected=422)

    def _post(self, path: str, document: dict[str, Any], name: str, expected: int = 200) -> None:
        body = json.dumps(document)
        with self.client.post(path, data=body, headers=JSON, name=name, catch_response=True) as response:
            if response.status_code in (expected, 202):
                response.success()
            elif response.status_code == 429:
                # Counted by itself; a polite client waits, this one waits a tenth of it to keep the load up.
                response.request_meta["name"] = f"{name}: 429"
                response.success()
                time.sleep(0.1 * float(response.headers.get("Retry-After", 1)))
            else:
                response.failure(f"{response.status_code}: {response.text[:200]}")


# How many of a hundred or so of each.
_SHARES = {
    Farmhand.render: 60,
    Farmhand.render_again: 15,
    Farmhand.canonical: 10,
    Farmhand.job: 5,
    Farmhand.mistake: 5,
}
Farmhand.tasks = [task for task, share in _SHARES.items() for _ in range(share)]
