"""The progress of jobs as server-sent events."""

import httpx
import pytest

from tests.service.jobs.asking import batch, ended, events_of, submit

pytestmark = pytest.mark.anyio


async def test_events_tell_every_frame_once_and_the_end(client: httpx.AsyncClient) -> None:
    job = await submit(client, batch(4))
    response = await client.get(job["events"])
    assert response.headers["content-type"].startswith("text/event-stream")
    events = events_of(response.text)
    frames = [(event_id, data["frame"], data["frames_total"]) for name, event_id, data in events if name == "frame"]
    assert [event_id for event_id, _, _ in frames] == ["1", "2", "3", "4"]
    assert sorted(number for _, number, _ in frames) == [0, 1, 2, 3]
    name, event_id, data = events[-1]
    assert (name, event_id, data["state"], data["frames_done"]) == ("end", "end", "succeeded", 4)
    assert next(name for name, _, _ in events) in ("progress", "frame")


async def test_events_go_on_where_the_last_stream_was_cut(client: httpx.AsyncClient) -> None:
    job = await ended(client, (await submit(client, batch(4)))["href"])
    rest = events_of((await client.get(job["events"], headers={"Last-Event-ID": "3"})).text)
    assert [event_id for name, event_id, _ in rest if name != "progress"] == ["4", "end"]
    over = await client.get(job["events"], headers={"Last-Event-ID": "end"})
    assert (over.status_code, over.content) == (204, b"")
    for strange in ("-1", "x", "1e3", "99999999999"):
        told = events_of((await client.get(job["events"], headers={"Last-Event-ID": strange})).text)
        assert [event_id for name, event_id, _ in told if name == "frame"] == ["1", "2", "3", "4"]
