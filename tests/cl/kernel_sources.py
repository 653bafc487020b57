"""Kernels with edits: what tests build to see that a fault is noticed, or that a constant does not matter."""

import importlib.resources
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

Edit = tuple[str, str, str]  # file, text, replacement


def edit_kernels(folder: Path, edits: Sequence[Edit], patch: pytest.MonkeyPatch) -> None:
    """From here on programs are built from a copy of the kernels, in `folder`, in which every edit is made.

    Every text must be there: an edit of something that has been renamed would test nothing.
    """
    resources_of = importlib.resources.files
    copies = folder / "kernels"
    copies.mkdir(parents=True)
    for source in (resources_of("conicoid") / "kernels").iterdir():
        text = source.read_text(encoding="utf-8")
        for file, before, after in edits:
            if file == source.name:
                assert before in text, f"{file} has no {before!r}"
                text = text.replace(before, after)
        (copies / source.name).write_text(text, encoding="utf-8")
    assert {file for file, _, _ in edits} <= {path.name for path in copies.iterdir()}

    def files(package: str) -> Any:
        return folder if package == "conicoid" else resources_of(package)

    patch.setattr(importlib.resources, "files", files)
