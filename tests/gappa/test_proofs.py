"""The proofs of the kernels' constants: Gappa accepts each as it stands, and none that says more.

A script's first lines say what is proven and assumed, which lines of the kernels it is about (`kernel FILE: TEXT`) and
what makes it too strong to be true (`refused: TEXT => TEXT`).
"""

import importlib.resources
import re
import subprocess
from pathlib import Path

import pytest

SCRIPTS = sorted(Path(__file__).parent.glob("*.g"))


def notes(script: Path, kind: str) -> list[str]:
    return re.findall(rf"^# {kind}:? (.*)$", script.read_text(encoding="utf-8"), re.MULTILINE)


def gappa(text: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["gappa"], input=text, check=False, capture_output=True, text=True)


def test_there_are_proofs() -> None:
    assert len(SCRIPTS) >= 10


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_proof_is_accepted(script: Path) -> None:
    done = gappa(script.read_text(encoding="utf-8"))
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("script", "change"),
    [(script, change) for script in SCRIPTS for change in notes(script, "refused")],
    ids=lambda value: value.stem if isinstance(value, Path) else value,
)
def test_a_stronger_claim_is_refused(script: Path, change: str) -> None:
    before, after = change.split(" => ")
    lines = script.read_text(encoding="utf-8").splitlines(keepends=True)
    claim = "".join(line for line in lines if not line.startswith("#"))
    assert before in claim
    done = gappa(claim.replace(before, after))
    assert done.returncode == 1
    assert re.search("some properties were not satisfied|no contradiction was found", done.stderr)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_proof_is_of_what_the_kernel_says(script: Path) -> None:
    quotes = notes(script, "kernel")
    assert quotes
    assert notes(script, "refused")
    for quote in quotes:
        name, text = quote.split(": ", 1)
        kernel = importlib.resources.files("conicoid") / "kernels" / name
        assert text in kernel.read_text(encoding="utf-8")
