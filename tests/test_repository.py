"""What holds for every text file of the repository."""

import re
import subprocess

import pytest

from tests.checkout import ROOT

CODE = {".py", ".cl", ".toml", ".md", "", ".yml", ".yaml"}
MAX_LINES = 350
ABSOLUTE_PATH = r"(?<![\w.])/(?:root|work|home)/\w"
PACKAGE_INDEX = r"(?:pypi|pythonhosted|deb\.debian)\.org"
ONE_MACHINE = re.compile(f"{ABSOLUTE_PATH}|{PACKAGE_INDEX}")


def tracked_text() -> dict[str, str]:
    listing = subprocess.run(["git", "ls-files"], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True).stdout
    paths = [ROOT / line for line in listing.splitlines()]
    # A tracked file may be gone from the work tree, and pictures are not text.
    texts = {path: path.read_bytes() for path in paths if path.is_file()}
    return {str(path.relative_to(ROOT)): data.decode() for path, data in texts.items() if b"\0" not in data}


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    return tracked_text()


def test_no_file_is_too_long_to_be_read_in_one_go(texts: dict[str, str]) -> None:
    # A history grows, and a generated report has a line for every scene.
    lists = {"CHANGELOG.md", "docs/stress-report.md"}
    lengths = {name: text.count("\n") for name, text in texts.items() if (ROOT / name).suffix in CODE}
    assert {name: length for name, length in lengths.items() if length > MAX_LINES and name not in lists} == {}


def test_nothing_names_one_machine_or_one_package_index(texts: dict[str, str]) -> None:
    found = {name: sorted(set(ONE_MACHINE.findall(text))) for name, text in texts.items()}
    assert {name: hits for name, hits in found.items() if hits} == {}
