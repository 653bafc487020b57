"""Rows of kept scenes: who goes when there is no more room."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from conicoid_service.jobs.scenes import Scenes
from conicoid_service.kept_scenes import Kept
from tests.service.jobs.stores import opened

LIMIT = 10


@pytest.fixture
def scenes(tmp_path: Path) -> Iterator[Scenes]:
    with opened(tmp_path) as store:
        yield Scenes(store.database, LIMIT)


def put(scenes: Scenes, scene_id: str, size: int, now_ms: int, **uses: int) -> None:
    scenes.put(Kept(scene_id, 1, size), uses, now_ms)


def kept(scenes: Scenes) -> str:
    return "".join(one for one in "abcde" if scenes.find(one))


def test_whoever_was_not_used_for_longest_goes_and_no_more_than_must(scenes: Scenes) -> None:
    for now_ms, scene_id in enumerate("abcd"):
        put(scenes, scene_id, 3, now_ms)
    assert kept(scenes) == "bcd"
    scenes.note({"b": 10})
    put(scenes, "e", 4, 11)
    assert kept(scenes) == "bde"
    put(scenes, "a", 10, 12)
    assert kept(scenes) == "a"


def test_uses_that_come_with_a_scene_count_for_it(scenes: Scenes) -> None:
    put(scenes, "a", 5, 1)
    put(scenes, "b", 5, 2)
    put(scenes, "c", 5, 4, a=3)
    assert kept(scenes) == "ac"


def test_kept_again_takes_its_room_once(scenes: Scenes) -> None:
    put(scenes, "a", 5, 1)
    put(scenes, "b", 5, 2)
    put(scenes, "a", 4, 3)
    assert scenes.find("a") == (Kept("a", 1, 4), 3)
    assert kept(scenes) == "ab"


def test_scene_of_a_server_whose_clock_is_late_stays_when_it_is_kept(scenes: Scenes) -> None:
    put(scenes, "a", 6, 1000)
    put(scenes, "b", 6, 1)
    assert kept(scenes) == "b"


def test_time_of_a_use_never_goes_back_and_revives_nothing(scenes: Scenes) -> None:
    put(scenes, "a", 1, 5)
    scenes.note({"a": 3, "b": 4})
    assert scenes.find("a") == (Kept("a", 1, 1), 5)
    scenes.drop("a")
    scenes.note({"a": 9})
    assert kept(scenes) == ""
