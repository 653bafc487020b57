"""Running the `conicoid` command as a user does, in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

CONICOID = str(Path(sys.executable).with_name("conicoid"))

# No server unless a test sets one; output buffered, as it is for users; warnings are errors.
ENVIRONMENT = {
    **{name: value for name, value in os.environ.items() if name not in ("CONICOID_SERVER", "PYTHONUNBUFFERED")},
    "PYTHONWARNINGS": "error",
}


def conicoid(
    *arguments: str, stdin: bytes = b"", cwd: Path | None = None, **environment: str
) -> "subprocess.CompletedProcess[bytes]":
    """Run the command to its end."""
    return subprocess.run(
        [CONICOID, *arguments],
        input=stdin,
        capture_output=True,
        check=False,
        cwd=cwd,
        env={**ENVIRONMENT, **environment},
    )


def paragraph(done: "subprocess.CompletedProcess[bytes]") -> str:
    """The error text: one paragraph that names the command, and no traceback."""
    text = done.stderr.decode()
    assert text.startswith("conicoid: ")
    assert text.endswith("\n")
    assert "\n\n" not in text
    assert "Traceback" not in text
    return text
