"""Files of the job store: whole or not there."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest

from conicoid_service.blob import Blob
from conicoid_service.jobs.folder import Folder
from conicoid_service.jobs.holder import Holder

LATER_MS = 10**14


def content(folder: Folder, name: str) -> bytes | None:
    blob = folder.open(name)
    if blob is None:
        return None
    with blob:
        return blob.read()


def test_file_is_read_as_it_was_written(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    data = os.urandom(3_000_000)
    with Blob.of(data) as blob:
        folder.write("abc", blob)
    assert content(folder, "abc") == data
    assert content(folder, "abd") is None
    assert list(folder.names(LATER_MS)) == ["abc"]


def test_full_disk_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = Folder(tmp_path)

    def refuse(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)
    with Blob.of(b"data") as blob, pytest.raises(OSError, match="No space"):
        folder.write("abc", blob)
    assert [file for file in tmp_path.rglob("*") if file.is_file()] == []


def test_what_dead_writers_left_is_swept_when_it_is_old(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    (tmp_path / "incoming" / "abc.1234").write_bytes(b"half")
    folder.sweep(older_than_ms=0)
    assert (tmp_path / "incoming" / "abc.1234").exists()
    folder.sweep(older_than_ms=LATER_MS)
    assert not (tmp_path / "incoming" / "abc.1234").exists()


def test_touched_file_is_young(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    with Blob.of(b"data") as blob:
        folder.write("abc", blob)
    os.utime(tmp_path / "ab" / "abc", (1, 1))
    assert list(folder.names(2000)) == ["abc"]
    assert folder.is_older("abc", 2000)
    assert folder.touch("abc")
    assert list(folder.names(2000)) == []
    assert not folder.is_older("abc", 2000)
    assert not folder.touch("abd")
    assert not folder.is_older("abd", LATER_MS)


def test_open_file_outlives_its_removal(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    with Blob.of(b"data") as blob:
        folder.write("abc", blob)
    reading = folder.open("abc")
    assert reading is not None
    folder.remove("abc")
    folder.remove("abc")
    with reading:
        assert reading.read() == b"data"


def test_holder_lives_until_it_is_closed(tmp_path: Path) -> None:
    one, other = Holder(tmp_path), Holder(tmp_path)
    assert other.lives(one.name)
    assert one.lives(other.name)
    one.close()
    assert not other.lives(one.name)
    other.close()
    assert list(tmp_path.iterdir()) == []


def test_holder_that_was_killed_is_dead(tmp_path: Path) -> None:
    mine = Holder(tmp_path)
    program = (
        "import os, pathlib, sys; from conicoid_service.jobs.holder import Holder\n"
        "holder = Holder(pathlib.Path(sys.argv[1])); print(holder.name, flush=True); os.kill(os.getpid(), 9)"
    )
    name = subprocess.run(
        [sys.executable, "-c", program, tmp_path], stdout=subprocess.PIPE, text=True, check=False
    ).stdout.strip()
    assert (tmp_path / name).exists()
    assert not mine.lives(name)
    assert not (tmp_path / name).exists()
    mine.close()
