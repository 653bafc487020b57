"""Files that are fetched once."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from conicoid_service.blob import Blob
from conicoid_service.jobs.folder import Folder
from conicoid_service.jobs.near import Near


@pytest.fixture
def far(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


@pytest.fixture
def near(far: Folder) -> Iterator[Near]:
    made = Near(far, 100)
    yield made
    made.close()


def write(far: Folder, name: str, size: int) -> None:
    with Blob.of(b"x" * size) as blob:
        far.write(name, blob)


def size_of(near: Near, name: str) -> int | None:
    blob = near.open(name)
    if blob is None:
        return None
    with blob:
        return len(blob)


def test_file_is_fetched_once(near: Near, far: Folder) -> None:
    write(far, "one", 10)
    assert size_of(near, "one") == 10
    far.remove("one")
    assert size_of(near, "one") == 10


def test_what_is_removed_through_it_is_gone(near: Near, far: Folder) -> None:
    write(far, "one", 10)
    size_of(near, "one")
    near.remove("one")
    assert size_of(near, "one") is None
    assert far.open("one") is None


def test_room_is_bounded_and_who_was_used_longest_ago_goes_first(near: Near, far: Folder) -> None:
    for name in ("one", "two", "six"):
        write(far, name, 40)
    size_of(near, "one")
    size_of(near, "two")
    size_of(near, "one")
    size_of(near, "six")
    for name in ("one", "two", "six"):
        far.remove(name)
    assert [size_of(near, name) for name in ("one", "two", "six")] == [40, None, 40]


def test_file_that_is_larger_than_the_room_is_given_all_the_same(near: Near, far: Folder) -> None:
    write(far, "large", 101)
    assert size_of(near, "large") == 101
    assert size_of(near, "large") == 101
