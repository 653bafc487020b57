"""Units: bands of large frames, and what workers of a farm do to them."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from conicoid_service.jobs.records import PRIORITIES, Claim, Unit
from tests.service.jobs.stores import BAND_PIXELS, Store, image, new_job, opened

# Two bands and a bit.
LARGE = (0, 0, 50, 2 * BAND_PIXELS // 50 + 1)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with opened(tmp_path) as made:
        yield made


def places(store: Store, count: int) -> list[tuple[int, int]]:
    """Number and band of the units that are taken next."""
    return [(claim.number, claim.band) for claim in (store.take() for _ in range(count))]


def states(store: Store, job_id: str) -> list[str]:
    return [frame.state for frame in store.jobs.frames(job_id, 0, 100)]


def test_frame_that_is_small_enough_is_one_unit(store: Store) -> None:
    store.submit(2)
    assert places(store, 2) == [(0, 0), (1, 0)]
    assert store.work.claim(0) is None


def test_bands_of_a_large_frame_are_rendered_and_then_joined(store: Store) -> None:
    job_id = store.submit(1, crop=LARGE)
    bands = [store.take() for _ in range(3)]
    assert [(claim.band, claim.bands) for claim in bands] == [(1, 3), (2, 3), (3, 3)]
    assert store.work.claim(0) is None
    for claim in reversed(bands):
        assert states(store, job_id) == ["queued" if claim is bands[2] else "running"]
        assert store.work.claim(0) is None
        assert store.work.finish(claim, image(f"band {claim.band}"), 1)
        assert store.jobs.get(job_id, "").frames_done == 0
    whole = store.take()
    assert (whole.band, whole.bands) == (0, 3)
    assert store.work.bands(whole) == ["band 1", "band 2", "band 3"]
    assert store.work.finish(whole, image("whole"), 2)
    assert store.jobs.get(job_id, "").state == "succeeded"
    assert [frame.tag for frame in store.jobs.frames(job_id, 0, 100)] == ["whole"]


def test_images_of_bands_make_room_once_their_frame_has_ended(store: Store) -> None:
    store.submit(1, crop=LARGE)
    for _ in range(3):
        claim = store.take()
        store.work.finish(claim, image(f"band {claim.band}", 10), 0)
    assert (store.upkeep.evict(0), store.upkeep.overdrawn(0)) == ([], 30)
    store.work.finish(store.take(), image("whole", 25), 0)
    assert sorted(store.upkeep.evict(0)) == ["band 1", "band 2", "band 3"]
    assert store.upkeep.overdrawn(0) == 25


def test_band_that_fails_fails_its_frame_and_ends_the_other_bands(store: Store) -> None:
    job_id = store.submit(2, crop=LARGE)
    first, second = store.take(), store.take()
    assert store.work.fail(first, "render-timeout", "too slow", 1)
    frame = store.jobs.frames(job_id, 0, 1)[0]
    assert (frame.state, frame.error_code, frame.ended_as) == ("failed", "render-timeout", 1)
    assert not store.work.finish(second, image(), 2)
    assert not store.work.is_ours(second)
    assert places(store, 3) == [(1, 1), (1, 2), (1, 3)]
    assert store.jobs.get(job_id, "").frames_failed == 1


def test_cancelled_job_takes_its_bands_along(store: Store) -> None:
    job_id = store.submit(1, crop=LARGE)
    claim = store.take()
    store.jobs.cancel(job_id, "", 1)
    assert store.work.claim(2) is None
    assert not store.work.finish(claim, image(), 3)
    assert store.upkeep.counts("frames")["cancelled"] == 1


def test_high_priority_comes_first(store: Store) -> None:
    store.submit(1, quadrics_hash="normal")
    store.submit(1, quadrics_hash="high", priority=PRIORITIES["high"])
    assert [store.take().quadrics_hash, store.take().quadrics_hash] == ["high", "normal"]


def delivered(store: Store, unit: Unit, now_ms: int = 100, lost_before_ms: int = 0) -> Claim | None:
    return store.work.take(unit, now_ms, lost_before_ms=lost_before_ms)


def test_unit_that_is_delivered_twice_is_rendered_once(tmp_path: Path) -> None:
    with opened(tmp_path, holder="a") as a, opened(tmp_path, holder="b") as b:
        unit = Unit(a.submit(1), 0, 0)
        claim = delivered(a, unit)
        assert claim is not None
        assert claim.attempts == 1
        assert delivered(b, unit) is None
        assert a.work.finish(claim, image(), 101)
        assert delivered(b, unit, lost_before_ms=10**6) is None


def test_unit_of_a_worker_that_has_gone_is_taken_over(tmp_path: Path) -> None:
    with opened(tmp_path, holder="a") as a, opened(tmp_path, holder="b") as b:
        unit = Unit(a.submit(1), 0, 0)
        lost = delivered(a, unit, now_ms=100)
        assert lost is not None
        a.work.renew(lost, 200)
        assert delivered(b, unit, now_ms=300, lost_before_ms=200) is None
        again = delivered(b, unit, now_ms=300, lost_before_ms=201)
        assert again is not None
        assert again.attempts == 2
        assert not a.work.is_ours(lost)
        assert not a.work.finish(lost, image("late"), 301)
        assert b.work.finish(again, image("again"), 302)


@pytest.mark.parametrize("unit", [Unit("no such job", 0, 0), Unit("", 9, 0), Unit("", 0, 1)])
def test_unit_that_is_not_there_is_nobodys(store: Store, unit: Unit) -> None:
    job_id = store.submit(1)
    assert delivered(store, Unit(unit.job_id or job_id, unit.number, unit.band)) is None
    assert store.jobs.get(job_id, "").state == "queued"


def test_frame_is_not_joined_before_its_bands_are_there(store: Store) -> None:
    job_id = store.jobs.create(new_job(1, crop=LARGE), 0)[0].id
    assert delivered(store, Unit(job_id, 0, 0)) is None
