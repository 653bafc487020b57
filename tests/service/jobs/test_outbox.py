"""Units on their way to a broker, and back."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from conicoid_service.jobs.records import PRIORITIES, Unit
from tests.service.jobs.stores import Store, image, opened

NORMAL, HIGH = PRIORITIES["normal"], PRIORITIES["high"]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with opened(tmp_path) as made:
        yield made


def test_units_are_sent_once_and_counted_until_they_are_taken(store: Store) -> None:
    job_id = store.submit(5)
    sent = store.outbox.take(NORMAL, 3, 1)
    assert sent == [Unit(job_id, k, 0) for k in range(3)]
    assert store.outbox.out(NORMAL) == 3
    assert store.outbox.take(NORMAL, 9, 1) == [Unit(job_id, k, 0) for k in (3, 4)]
    assert store.outbox.take(NORMAL, 9, 1) == []
    store.work.take(sent[0], 2, lost_before_ms=0)
    assert store.outbox.out(NORMAL) == 4


def test_owners_have_equal_parts_of_what_is_sent(store: Store) -> None:
    for owner, frames in (("a", 100), ("b", 100), ("c", 1)):
        store.submit(frames, owner)
    jobs = Counter(unit.job_id for unit in store.outbox.take(NORMAL, 9, 0))
    assert sorted(jobs.values()) == [1, 3, 3]


def test_no_owner_waits_for_another_however_few_units_are_sent_at_a_time(store: Store) -> None:
    ids = {store.submit(20, owner): owner for owner in ("a", "b", "c")}
    owners = [ids[unit.job_id] for _ in range(6) for unit in store.outbox.take(NORMAL, 2, 0)]
    assert owners == list("abcabcabcabc")


def test_each_priority_is_sent_by_itself(store: Store) -> None:
    normal, high = store.submit(1), store.submit(1, priority=HIGH)
    assert [unit.job_id for unit in store.outbox.take(HIGH, 9, 0)] == [high]
    assert [unit.job_id for unit in store.outbox.take(NORMAL, 9, 0)] == [normal]
    assert store.outbox.recall_sent(HIGH, 1) == 1
    assert (store.outbox.out(HIGH), store.outbox.out(NORMAL)) == (0, 1)


def test_what_was_not_sent_after_all_is_sent_again(store: Store) -> None:
    store.submit(2)
    units = store.outbox.take(NORMAL, 2, 0)
    store.outbox.give_back(units[1:])
    assert store.outbox.take(NORMAL, 2, 0) == units[1:]


def test_what_the_broker_lost_is_sent_again(store: Store) -> None:
    store.submit(2)
    first = store.outbox.take(NORMAL, 1, 10)
    store.outbox.take(NORMAL, 1, 20)
    assert store.outbox.recall_sent(NORMAL, 20) == 1
    assert store.outbox.take(NORMAL, 2, 30) == first


def test_unit_of_a_silent_worker_is_sent_again_and_that_of_another_not(store: Store) -> None:
    store.submit(2)
    units = store.outbox.take(NORMAL, 2, 0)
    silent, alive = (store.work.take(unit, 100, lost_before_ms=0) for unit in units)
    assert silent is not None
    assert alive is not None
    store.work.renew(alive, 200)
    assert store.outbox.recall_running(200) == 1
    assert store.outbox.take(NORMAL, 2, 300) == units[:1]
    assert not store.work.finish(silent, image(), 301)
    assert store.work.finish(alive, image(), 302)


def test_released_unit_is_sent_again_when_its_time_has_come(store: Store) -> None:
    store.submit(1)
    (unit,) = store.outbox.take(NORMAL, 1, 0)
    claim = store.work.take(unit, 0, lost_before_ms=0)
    assert claim is not None
    store.work.release(claim, not_before_ms=50, counts=False)
    assert store.outbox.take(NORMAL, 1, 49) == []
    assert store.outbox.take(NORMAL, 1, 50) == [unit]


def test_dead_unit_fails_its_frame_alone_and_one_that_was_only_unlucky_is_sent_again(store: Store) -> None:
    job_id = store.submit(2)
    poison, unlucky = store.outbox.take(NORMAL, 2, 0)
    for now_ms in range(4):
        assert store.work.take(poison, now_ms, lost_before_ms=now_ms + 1)
    assert store.outbox.bury(poison, "render-crashed", "it ends its workers", 4, 9)
    frame = store.jobs.frames(job_id, 0, 1)[0]
    assert (frame.state, frame.error_code, frame.error_detail) == ("failed", "render-crashed", "it ends its workers")
    assert not store.outbox.bury(unlucky, "render-crashed", "", 4, 9)
    assert store.outbox.take(NORMAL, 2, 10) == [unlucky]
    assert store.work.take(unlucky, 10, lost_before_ms=0)
    assert not store.outbox.bury(unlucky, "render-crashed", "", 4, 10)
    assert store.outbox.take(NORMAL, 2, 10) == []  # it is being rendered
    assert not store.outbox.bury(poison, "render-crashed", "", 4, 11)
    assert store.jobs.get(job_id, "").frames_failed == 1


def test_dead_band_fails_its_frame(store: Store) -> None:
    job_id = store.submit(1, crop=(0, 0, 100, 20))
    band = store.outbox.take(NORMAL, 1, 0)[0]
    assert band.band == 1
    assert store.work.take(band, 0, lost_before_ms=0)
    assert store.outbox.bury(band, "render-crashed", "", 1, 1)
    assert store.jobs.get(job_id, "").state == "failed"
