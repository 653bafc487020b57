"""How following a job ends when not every frame arrives."""

import argparse
import errno
import os
import re
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest

from conicoid_client import Client, Job
from conicoid_client.command import follow
from conicoid_client.command.report import Failure
from conicoid_client.frame_files import FrameFiles
from tests.clients.job_answers import ID, event, events, frame_event, image, job

Follow = Callable[..., None]


@pytest.fixture
def followed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Follow:
    """Follow a job of which these are the events; frames go to a folder."""

    def run(*sent: httpx.Response) -> None:
        streams = iter(sent)

        def handle(request: httpx.Request) -> httpx.Response:
            if request.url.path.endswith("events"):
                return next(streams)
            number = int(request.url.path.rpartition("/")[2])
            headers = {"Content-Type": "image/x-exr", "ETag": f'"tag-{number}"'}
            return httpx.Response(200, headers=headers, content=image(number))

        client = Client("http://service.test", transport=httpx.MockTransport(handle))
        monkeypatch.setattr(follow, "connect_to_server", lambda *_, **__: client)
        options = argparse.Namespace(output="DIR", server="http://service.test")
        follow.follow(options, Job.read(job()), FrameFiles(tmp_path))

    return run


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.exr"))


def test_failed_frames_are_named_with_their_causes_and_the_others_are_there(followed: Follow, tmp_path: Path) -> None:
    sent = (
        frame_event(1, 0),
        frame_event(2, 2, failed=1, error="it ended two processes"),
        frame_event(3, 1, failed=1),
        event("end", job("failed", 2, 1), "end"),
    )
    with pytest.raises(Failure) as caught:
        followed(events(*sent))
    assert str(caught.value).splitlines() == [
        f"1 of 3 frames of job {ID} failed; the others are done in DIR",
        "frame 2: it ended two processes [render-crashed]",
    ]
    assert names(tmp_path) == ["frame-00000.exr", "frame-00001.exr"]


def test_a_cancelled_job_is_no_success(followed: Follow) -> None:
    with pytest.raises(Failure, match="cancelled: 1 of 3 frames are done"):
        followed(events(frame_event(1, 0), event("end", job("cancelled", 1), "end")))


def test_a_full_disk_leaves_no_half_file_and_says_how_to_go_on(
    followed: Follow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("conicoid_client.files.os.fsync", full)
    with pytest.raises(
        Failure, match=f"written to DIR: no space left on device\ngo on with: conicoid jobs wait {ID} -o DIR --server"
    ):
        followed(events(frame_event(1, 0)))
    assert list(tmp_path.iterdir()) == []


def test_a_job_that_expired_meanwhile_is_said_to_have(followed: Follow, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("conicoid_client.events.time.sleep", lambda _: None)
    gone = httpx.Response(404, json={"code": "unknown-job", "detail": "there is no such job"})
    with pytest.raises(Failure, match=re.escape(f"job {ID} is not there any more")):
        followed(events(frame_event(1, 0), cut=True), gone)
