"""What happens to jobs and frames in the database."""

import json
import tracemalloc
from collections import Counter
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import get_args

import pytest
from sqlalchemy import Connection, select

from conicoid_service.errors import IdempotencyKeyError, JobLimitError, UnknownJobError
from conicoid_service.jobs.records import STATES
from conicoid_service.jobs.tables import frames
from conicoid_service.jobs.upkeep import Counted
from tests.service.jobs.stores import LIFETIME_MS, Store, image, new_job, opened


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with opened(tmp_path) as made:
        yield made


def numbers(store: Store, job_id: str, state: str) -> list[int]:
    return [frame.number for frame in store.jobs.frames(job_id, 0, 1000) if frame.state == state]


def test_job_goes_from_queued_by_running_to_succeeded(store: Store) -> None:
    job_id = store.submit(2, now_ms=5)
    assert (store.jobs.get(job_id, "").state, store.jobs.get(job_id, "").started_ms) == ("queued", None)
    first, second = store.take(7), store.take(8)
    assert (store.jobs.get(job_id, "").state, store.jobs.get(job_id, "").started_ms) == ("running", 7)
    assert store.work.claim(8) is None
    assert store.work.finish(second, image(), 9)
    assert store.jobs.get(job_id, "").state == "running"
    assert store.work.finish(first, image(), 10)
    job = store.jobs.get(job_id, "")
    assert (job.state, job.finished_ms, job.expires_ms) == ("succeeded", 10, 10 + LIFETIME_MS)
    assert (job.frames_total, job.frames_done, job.frames_failed) == (2, 2, 0)
    assert [(frame.number, frame.ended_as, frame.bytes) for frame in store.jobs.frames(job_id, 0, 9)] == [
        (0, 2, 10),
        (1, 1, 10),
    ]


def test_frames_are_taken_in_order_with_what_rendering_needs(store: Store) -> None:
    job_id = store.submit(2, quadrics_hash="abc", owner="me")
    claims = [store.take(), store.take()]
    assert [(one.job_id, one.number, one.owner, one.quadrics_hash) for one in claims] == [
        (job_id, 0, "me", "abc"),
        (job_id, 1, "me", "abc"),
    ]
    assert [one.scene_hash for one in claims] == ["hash 0", "hash 1"]
    assert store.work.frame(job_id, 1) == claims[1]


def test_one_failed_frame_fails_its_job_and_no_other_frame(store: Store) -> None:
    job_id = store.submit(3)
    for claim in (store.take(), store.take(), store.take()):
        if claim.number == 1:
            assert store.work.fail(claim, "render-crashed", "it died", 1)
        else:
            assert store.work.finish(claim, image(), 1)
    job = store.jobs.get(job_id, "")
    assert (job.state, job.frames_done, job.frames_failed) == ("failed", 2, 1)
    failed = store.jobs.frames(job_id, 1, 1)[0]
    assert (failed.error_code, failed.error_detail, failed.tag) == ("render-crashed", "it died", None)


def test_owners_take_turns_however_much_each_has(store: Store) -> None:
    store.submit(5, owner="a")
    store.submit(5, owner="a")
    store.submit(2, owner="b")
    store.submit(2, owner="c")
    assert "".join(store.take().owner for _ in range(8)) == "abcabcaa"


def test_cancelled_job_gives_nothing_to_render_and_takes_no_image(store: Store) -> None:
    job_id = store.submit(3)
    done, running = store.take(), store.take()
    store.work.finish(done, image(), 1)
    job, did = store.jobs.cancel(job_id, "", 2)
    assert (job.state, job.finished_ms, did) == ("cancelled", 2, True)
    assert store.work.claim(3) is None
    assert not store.work.is_ours(running)
    assert not store.work.finish(running, image("late"), 4)
    assert not store.work.fail(running, "code", "detail", 4)
    assert store.jobs.cancel(job_id, "", 5) == (job, False)
    assert numbers(store, job_id, "succeeded") == [0]
    assert numbers(store, job_id, "cancelled") == [1, 2]


def test_released_frame_is_taken_again_and_counted_where_it_should(store: Store) -> None:
    store.submit()
    store.work.release(store.take(), not_before_ms=0, counts=False)
    claim = store.take()
    assert claim.attempts == 1
    store.work.release(claim, not_before_ms=50, counts=True)
    assert store.work.claim(49) is None
    assert store.take(50).attempts == 2


def test_frames_of_a_dead_server_are_taken_up_by_another(tmp_path: Path) -> None:
    with opened(tmp_path, holder="dead") as dead, opened(tmp_path) as living:
        job_id = dead.submit(3)
        lost, own = dead.take(), living.take()
        assert living.work.holders() == {"dead", "me"}
        assert living.work.take_from("dead") == 1
        assert numbers(living, job_id, "queued") == [0, 2]
        assert living.take().attempts == 2
        # It was only slow, and comes back too late.
        assert not dead.work.finish(lost, image(), 1)
        dead.work.release(lost, not_before_ms=0, counts=False)
        assert living.work.is_ours(own)
        assert numbers(living, job_id, "running") == [0, 1]


def test_two_servers_never_take_the_same_frame(tmp_path: Path) -> None:
    with opened(tmp_path, holder="a") as a, opened(tmp_path, holder="b") as b:
        a.submit(6)
        assert [store.take().number for store in (a, b, b, a, b, a)] == [0, 1, 2, 3, 4, 5]


def test_ended_frames_are_told_from_where_a_client_left(store: Store) -> None:
    job_id = store.submit(4)
    claims = [store.take() for _ in range(4)]
    for k in (2, 0, 3):
        store.work.finish(claims[k], image(), 1)
    assert [frame.number for frame in store.jobs.progress(job_id, 0, 10)[1]] == [2, 0, 3]
    assert [frame.number for frame in store.jobs.progress(job_id, 1, 1)[1]] == [0]
    assert store.jobs.progress(job_id, 3, 10)[1] == []
    assert store.jobs.progress("no such job", 0, 10) == (None, [])


def test_same_key_makes_one_job_and_another_request_is_refused(store: Store) -> None:
    first, is_new = store.jobs.create(new_job(2, "me", idempotency_key="k"), 0)
    assert is_new
    assert store.jobs.create(new_job(2, "me", idempotency_key="k"), 1) == (first, False)
    with pytest.raises(IdempotencyKeyError, match=first.id):
        store.jobs.create(new_job(2, "me", idempotency_key="k", digest="other"), 1)
    assert store.jobs.create(new_job(2, "you", idempotency_key="k"), 1)[1]
    assert len(store.jobs.page("me", 10, None, None)) == 1


def test_owner_may_not_have_more_frames_than_the_limit(tmp_path: Path) -> None:
    with opened(tmp_path, owner_frame_limit=5) as store:
        job_id = store.submit(4, owner="a")
        with pytest.raises(JobLimitError, match="4 frames wait already and 2 more would pass the limit of 5"):
            store.submit(2, owner="a")
        store.submit(5, owner="b")
        store.jobs.cancel(job_id, "a", 1)
        store.submit(5, owner="a")


def test_pages_list_an_owners_jobs_newest_first(store: Store) -> None:
    ids = [store.submit(now_ms=k, owner="a") for k in range(5)]
    store.submit(owner="b")
    store.jobs.cancel(ids[3], "a", 9)
    first = store.jobs.page("a", 3, None, None)
    assert [job.id for job in first] == ids[:1:-1]
    assert [job.id for job in store.jobs.page("a", 3, first[-1].id, None)] == ids[1::-1]
    assert [job.id for job in store.jobs.page("a", 3, None, "cancelled")] == [ids[3]]


def test_another_owners_job_is_not_there(store: Store) -> None:
    job_id = store.submit(owner="a")
    with pytest.raises(UnknownJobError):
        store.jobs.get(job_id, "b")
    with pytest.raises(UnknownJobError):
        store.jobs.cancel(job_id, "b", 0)
    assert store.jobs.get(job_id, "a").state == "queued"


def test_states_are_counted(store: Store) -> None:
    cancelled = store.submit(3)
    store.jobs.cancel(cancelled, "", 1)
    store.submit(3)
    store.work.finish(store.take(), image(), 1)
    store.take()
    counts = {what: store.upkeep.counts(what) for what in get_args(Counted)}
    assert {state: count for state, count in counts["jobs"].items() if count} == {"cancelled": 1, "running": 1}
    assert counts["frames"] == {"queued": 1, "running": 1, "succeeded": 1, "failed": 0, "cancelled": 3}
    assert counts["bytes"] == {"": 10}


def test_frames_are_counted_as_they_stand_in_the_table(store: Store) -> None:
    """Whatever happened to them; a frame in bands is one frame, and its bands are none."""
    random = Random(1)
    for step in range(60):
        job_id = store.submit(random.randrange(1, 5), now_ms=step, crop=(0, 0, 20, random.choice([10, 200])))
        for _ in range(random.randrange(8)):
            if (claim := store.work.claim(step)) is None:
                break
            match random.randrange(4):
                case 0:
                    store.work.fail(claim, "code", "detail", step)
                case 1:
                    store.work.release(claim, not_before_ms=step + 1, counts=False)
                case 2:
                    store.work.finish(claim, image(), step)
        if random.random() < 0.2:
            store.jobs.cancel(job_id, "", step)
        if step % 20 == 0:
            store.upkeep.expire(step)
    with store.database.reading() as connection:
        states = Counter(connection.execute(select(frames.c.state).where(frames.c.band == 0)).scalars())
    assert min(states[state] for state in STATES) > 0
    assert store.upkeep.counts("frames") == {state: states[state] for state in STATES}


def test_image_that_a_job_comes_to_need_while_room_is_made_stays(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    for k in range(2):
        store.upkeep.remember(image(f"free {k}", 10), k)
    store.submit()
    claim, writing = store.take(), store.database.writing

    def after_another() -> AbstractContextManager[Connection]:
        monkeypatch.undo()
        store.work.finish(claim, image("free 0", 10), 0)
        return writing()

    monkeypatch.setattr(store.database, "writing", after_another)
    assert store.upkeep.evict(0) == ["free 1"]
    assert store.upkeep.counts("bytes") == {"": 10}


def test_room_that_cannot_be_made_keeps_nobody_from_writing(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    store.submit()
    store.work.finish(store.take(), image("needed", 10), 0)
    monkeypatch.setattr(store.database, "writing", None)
    assert store.upkeep.evict(100) == store.upkeep.evict(0) == []


def test_what_jobs_need_is_told_when_it_passes_the_limit(store: Store) -> None:
    store.submit()
    store.work.finish(store.take(), image("needed", 10), 0)
    store.upkeep.remember(image("free", 10), 0)
    assert [store.upkeep.overdrawn(limit) for limit in (20, 19, 10, 9)] == [None, None, None, 10]


def test_expired_job_is_gone_with_its_frames(store: Store) -> None:
    job_id = store.submit(2)
    store.jobs.cancel(job_id, "", 100)
    assert store.upkeep.expire(99 + LIFETIME_MS) == 0
    assert store.upkeep.expire(100 + LIFETIME_MS) == 1
    with pytest.raises(UnknownJobError):
        store.jobs.get(job_id, "")
    assert store.jobs.frames(job_id, 0, 10) == []


def test_room_is_made_by_what_no_job_needs_and_was_used_longest_ago(store: Store) -> None:
    store.submit(1)
    store.work.finish(store.take(), image("needed", 100), 0)
    for k in range(4):
        store.upkeep.remember(image(f"free {k}", 10), k)
    store.upkeep.image("free 0", 10**9)
    assert store.upkeep.evict(140) == []
    assert store.upkeep.evict(120) == ["free 1", "free 2"]
    assert store.upkeep.evict(0) == ["free 3", "free 0"]
    assert store.upkeep.evict(0) == []
    assert store.upkeep.counts("bytes") == {"": 100}
    store.upkeep.expire(10**12)
    assert store.upkeep.evict(0) == ["needed"]


def test_job_of_ten_thousand_frames_is_made_in_little_memory(tmp_path: Path) -> None:
    camera = {"crop": [0, 0, 9, 9], "name": "x" * 900}
    view = json.dumps({"camera": camera, "output": {"precision": "exact"}, "scene_hash": "hash"})
    job = replace(new_job(), frames_total=10_000, views=(view.encode() for _ in range(10_000)))
    with opened(tmp_path, owner_frame_limit=20_000) as store:
        store.submit(600)  # what is loaded once is
        tracemalloc.start()
        made, _ = store.jobs.create(job, 0)
        assert tracemalloc.get_traced_memory()[1] < 5_000_000  # all views are 10 MB
        tracemalloc.stop()
        assert [frame.number for frame in store.jobs.frames(made.id, 9_998, 9)] == [9_998, 9_999]
