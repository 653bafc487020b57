"""The wheel alone, away from the checkout."""

import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

from tests.checkout import ROOT

SOURCE_ROOTS = ("cl", "service", "clients", "bench/conicoid_bench")


def test_wheel_holds_every_file_of_the_four_packages(wheel: Path) -> None:
    list_files = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *SOURCE_ROOTS]
    listing = subprocess.run(list_files, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    expected = {path.partition("/")[2] for path in listing.stdout.splitlines()}
    packed = {name for name in ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert packed == expected
    assert any(name.endswith(".cl") for name in packed)


def test_wheel_alone_renders_the_checkouts_bytes(
    wheel: Path, scene: bytes, checkout_exr: bytes, tmp_path: Path
) -> None:
    venv = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", venv], check=True)
    pip, conicoid = venv / "bin" / "pip", venv / "bin" / "conicoid"
    lock = ROOT / "requirements" / "dev.txt"
    subprocess.run([pip, "install", "--quiet", "--only-binary=:all:", "--require-hashes", "-r", lock], check=True)
    subprocess.run([pip, "install", "--quiet", "--no-deps", "--no-index", wheel], check=True)
    rendered = subprocess.run(
        [conicoid, "render", "-", "-o", "-"], input=scene, stdout=subprocess.PIPE, cwd=tmp_path, check=True
    ).stdout
    assert rendered == checkout_exr
