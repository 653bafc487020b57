"""Whole files or nothing, and refusals before the work."""

import os
import stat
from pathlib import Path

import pytest

from conicoid_client import files


def test_written_bytes_are_there_and_nothing_else_is(tmp_path: Path) -> None:
    target = tmp_path / "out.exr"
    files.write(str(target), b"image")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"out.exr": b"image"}


def test_new_file_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "touched").touch()
    files.write(str(tmp_path / "written"), b"")
    assert (tmp_path / "written").stat().st_mode == (tmp_path / "touched").stat().st_mode


def test_replaced_file_keeps_its_permissions(tmp_path: Path) -> None:
    target = tmp_path / "out.exr"
    target.write_bytes(b"old")
    target.chmod(0o640)
    files.write(str(target), b"new")
    assert target.read_bytes() == b"new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


def test_a_link_stays_a_link_and_its_target_is_replaced(tmp_path: Path) -> None:
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_bytes(b"old")
    link.symlink_to(target)
    files.write(str(link), b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"


def test_a_failed_write_leaves_the_old_file_and_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "out.exr"
    target.write_bytes(b"old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        files.write(str(target), b"new")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"out.exr": b"old"}


def test_a_device_is_written_as_it_is() -> None:
    files.check_writable("/dev/null")
    files.write("/dev/null", b"image")
    assert Path("/dev/null").is_char_device()


@pytest.mark.parametrize(
    ("place", "error"),
    [(".", IsADirectoryError), ("missing/out.exr", FileNotFoundError), ("file/out.exr", FileNotFoundError)],
)
def test_what_cannot_be_written_is_refused_before_the_work(place: str, error: type[OSError], tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(error):
        files.check_writable(str(tmp_path / place))


@pytest.mark.parametrize("protected", ["file", "."])
def test_a_protected_file_or_directory_is_refused_before_the_work(
    protected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the system's own answer, which for root is always yes: so it is given here."""
    (tmp_path / "file").touch()
    place = (tmp_path / protected).resolve()
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) != place)
    with pytest.raises(PermissionError):
        files.check_writable(str(tmp_path / "file"))


def test_checking_creates_nothing(tmp_path: Path) -> None:
    files.check_writable(str(tmp_path / "out.exr"))
    assert not list(tmp_path.iterdir())
