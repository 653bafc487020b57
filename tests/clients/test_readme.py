"""What the README tells people to type works, and what it shows is what they get."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.checkout import BIN, ROOT
from tests.clients.command import ENVIRONMENT

README = (ROOT / "README.md").read_text()
OTHER_PAGES = ["docs/examples.md", "examples/README.md"]


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


def cheap(block: str) -> bool:
    """Whether it neither sets up nor tests the whole checkout; `make demo` and `make test` are tested as targets.

    A bare machine has no curl, and the README asks for none; .ci/run installs it.
    """
    return "make " not in block and ("curl " not in block or shutil.which("curl") is not None)


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A directory in which `examples/` is there and everything may be written."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    return tmp_path


def run(script: str, where: Path) -> "subprocess.CompletedProcess[str]":
    """Run a block as a shell does that stops at the first failure, and stop what it left in the background."""
    environment = {**ENVIRONMENT, "PATH": f"{BIN}:{ENVIRONMENT['PATH']}"}
    ending = "trap 'status=$?; kill $(jobs -p) 2>/dev/null || true; wait; exit $status' EXIT\n"
    return subprocess.run(
        ["bash", "-euo", "pipefail", "-c", ending + script],
        cwd=where,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    "script",
    [
        block
        for page in ["README.md", *OTHER_PAGES]
        for block in blocks((ROOT / page).read_text(), "sh")
        if cheap(block)
    ],
)
def test_shell_commands_work(script: str, checkout: Path, unused_port: int) -> None:
    done = run(script.replace("8000", str(unused_port)), checkout)
    assert done.returncode == 0, done.stderr
    written = re.findall(r"(?:-o|--output|--preview|>) (\S+)", script)
    assert written or "device" in script
    assert all((checkout / name).stat().st_size for name in written)


@pytest.mark.parametrize("program", blocks(README, "python"))
def test_python_programs_work(program: str, checkout: Path, address: str) -> None:
    (checkout / "out").mkdir()
    (checkout / "program.py").write_text(program.replace("http://127.0.0.1:8000", address))
    done = run("python -W error program.py", checkout)
    assert (done.returncode, done.stderr) == (0, "")
    assert "cast" in done.stdout
    assert list((checkout / "out").iterdir())


@pytest.mark.parametrize("session", blocks(README, "console"))
def test_sessions_show_what_the_command_says(session: str, checkout: Path) -> None:
    command, _, shown = session.removeprefix("$ ").partition("\n")
    done = run(f"set +e\n{command}", checkout)
    assert done.stdout + done.stderr == shown


@pytest.mark.parametrize("page", ["README.md", "CHANGELOG.md", "docs/any-farm.md", *OTHER_PAGES])
def test_links_lead_somewhere(page: str) -> None:
    links = re.findall(r"\]\(([^)#]+)\)", (ROOT / page).read_text())
    missing = [link for link in links if not (ROOT / page).parent.joinpath(link).exists()]
    assert not missing
