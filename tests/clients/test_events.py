"""A job's events: the format, and that cuts lose nothing and repeat nothing."""

from collections.abc import Iterator
from itertools import pairwise

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid_client import Client, ClientError, FrameEnded, JobEnded, ProblemError, Unreachable
from conicoid_client.events import Message, messages
from tests.clients.job_answers import ID, event, events, frame_event, job

STREAM = (
    b"\xef\xbb\xbf: hello\ndata: 1\nid: 7\n\nevent: frame\r\ndata:a\r\ndata:  b\r\n\r\n"
    b"event: x\rdata\r\revent: none\n\ndata: cut"
)
MEANT = [Message("message", "1", "7"), Message("frame", "a\n b", None), Message("x", "", None)]


@pytest.fixture(autouse=True)
def naps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The waits that were asked for; none of them is waited."""
    slept: list[float] = []
    monkeypatch.setattr("conicoid_client.events.time.sleep", slept.append)
    return slept


@given(st.sets(st.integers(0, len(STREAM))))
def test_events_do_not_depend_on_where_the_network_cuts_the_stream(cuts: set[int]) -> None:
    ends = [0, *sorted(cuts), len(STREAM)]
    assert list(messages(STREAM[a:b] for a, b in pairwise(ends))) == MEANT


@pytest.mark.parametrize("stream", [b"data: \xff\n\n", b"data: " + bytes(2 << 20), b"data: xxxx\n" * (1 << 19)])
def test_what_is_not_text_or_has_no_end_is_refused(stream: bytes) -> None:
    with pytest.raises(ClientError, match=r"UTF-8|MiB"):
        list(messages([stream]))


@pytest.mark.parametrize(
    "sent",
    [
        event("progress", []),
        event("progress", job() | {"id": "../x"}),
        event("progress", job() | {"frames_done": -1}),
        event("frame", job(), "1"),
        frame_event(1, 0).replace(b"\nid: 1", b""),
        frame_event(1, 0).replace(b"id: 1", b"id: one"),
        b"event: end\ndata: {\n\n",
    ],
)
def test_an_event_that_is_not_a_jobs_is_an_error(sent: bytes) -> None:
    with service(events(sent)) as client, pytest.raises(ClientError):
        list(client.events(ID))


def service(
    *answers: httpx.Response | httpx.HTTPError, asked: list[str | None] | None = None, patience_s: float = 2
) -> Client:
    remaining: Iterator[httpx.Response | httpx.HTTPError] = iter(answers)

    def handle(request: httpx.Request) -> httpx.Response:
        assert request.url.path == f"/v1/jobs/{ID}/events"
        if asked is not None:
            asked.append(request.headers.get("Last-Event-ID"))
        answer = next(remaining)
        if isinstance(answer, httpx.HTTPError):
            raise answer
        return answer

    return Client("http://service.test", transport=httpx.MockTransport(handle), patience_s=patience_s)


def test_cuts_lose_no_frame_and_repeat_none(naps: list[float]) -> None:
    asked: list[str | None] = []
    answers: list[httpx.Response | httpx.HTTPError] = [
        events(event("progress", job()), frame_event(1, 2), frame_event(2, 0)[:-5], cut=True),
        httpx.ConnectError("refused"),
        httpx.Response(502),
        httpx.Response(503, headers={"Retry-After": "1"}),
        events(event("progress", job(done=1)), frame_event(1, 2), frame_event(2, 0)),  # tells one again, then drains
        events(b": still here\n\n", event("news", "?"), frame_event(3, 1), event("end", job("succeeded", 3), "end")),
    ]
    with service(*answers, asked=asked, patience_s=10) as client:
        seen = list(client.events(ID))
    assert [e.frame.number for e in seen if isinstance(e, FrameEnded)] == [2, 0, 1]
    assert isinstance(seen[-1], JobEnded)
    assert asked == [None, "1", "1", "1", "1", "2"]
    assert len(naps) == 5


def test_the_job_that_was_waited_for_is_as_it_ended() -> None:
    with service(events(frame_event(1, 0), event("end", job("failed", 2, 1), "end"))) as client:
        assert (ended := client.wait(ID)).state == "failed"
        assert (ended.frames_done, ended.frames_failed, ended.ended) == (2, 1, True)


def test_after_the_end_there_are_no_events() -> None:
    with service(httpx.Response(204)) as client:
        assert list(client.events(ID, "end")) == []


def test_a_service_that_stays_away_is_given_up_within_the_patience(naps: list[float]) -> None:
    with service(*[httpx.ConnectError("refused")] * 20) as client, pytest.raises(Unreachable, match=r"service\.test"):
        list(client.events(ID))
    assert naps == [0.25, 0.5, 1.0]


def test_a_refusal_is_not_repeated(naps: list[float]) -> None:
    with service(httpx.Response(404)) as client, pytest.raises(ProblemError):
        list(client.events(ID))
    assert naps == []
