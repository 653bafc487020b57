"""A batch while everything that can end does: render processes, the service, the room on the disk."""

import hashlib
import json
import random
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.chaos.small_disk import SmallDisk
from tests.checkout import ROOT
from tests.running import Service

FRAMES = 200
ENDED = ("succeeded", "failed", "cancelled")
# One of each kind at least, the others by chance.
EVENTS = ("render", "service", "disk", "document", "render", "service")


def batch() -> dict[str, Any]:
    """The example of all shapes, seen by cameras that each look a little further."""
    document: dict[str, Any] = json.loads((ROOT / "examples/shapes.json").read_text("utf-8"))
    camera = document.pop("camera")
    return document | {"cameras": [{**camera, "width": 400, "height": 240, "far": 1000.0 + k} for k in range(FRAMES)]}


def digests(client: httpx.Client, href: str) -> list[str]:
    """SHA-256 of every frame's image."""
    found = []
    for k in range(FRAMES):
        response = client.get(f"{href}/frames/{k}")
        assert response.status_code == 200, response.text
        found.append(hashlib.sha256(response.content).hexdigest())
    return found


@contextmanager
def connected(service: Service) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=service.url, timeout=60) as client:
        yield client


def state(client: httpx.Client, href: str) -> str:
    found: str = client.get(f"{href}?frame_limit=0").json()["state"]
    return found


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What the frames are when nothing happens."""
    folder = tmp_path_factory.mktemp("calm")
    with Service(folder / "store", folder / "log") as service, connected(service) as client:
        href = client.post("/v1/jobs", json=batch()).json()["href"]
        while state(client, href) not in ENDED:
            time.sleep(0.2)
        found = digests(client, href)
        assert service.stop() == 0
    return found


def test_every_frame_arrives_once_whatever_ends_and_however_full_the_disk_is(
    tmp_path: Path, undisturbed: list[str]
) -> None:
    rng, happened = random.Random(5), Counter[str]()
    with SmallDisk(tmp_path / "disk", megabytes=200) as disk:
        service = Service(disk.path / "store", tmp_path / "log", disk.inside)
        with service, connected(service) as client:
            href = client.post("/v1/jobs", json=batch()).json()["href"]
            deadline = time.monotonic() + 240
            while state(client, href) not in ENDED:
                assert time.monotonic() < deadline, client.get(href).text
                time.sleep(rng.uniform(0.1, 0.5))
                event = EVENTS[happened.total()] if happened.total() < len(EVENTS) else rng.choice(EVENTS)
                happened[event] += 1
                if event == "service":
                    service.kill()
                    service.start()
                elif event == "disk":
                    disk.fill()
                    time.sleep(1.5)
                    disk.free()
                else:
                    service.kill_child(f"conicoid_service.{event}_process")
            assert set(happened) == set(EVENTS), happened
            assert digests(client, href) == undisturbed
            events = client.get(f"{href}/events").text
            assert service.stop() == 0
    assert "the disk does not take it" in (tmp_path / "log").read_text()
    told = [json.loads(line.removeprefix("data: "))["frame"] for line in events.splitlines() if '"frame":' in line]
    assert sorted(told) == list(range(FRAMES))
