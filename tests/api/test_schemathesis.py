"""The service against its own OpenAPI document, by Schemathesis: all phases, stateful ones included."""

import subprocess
import sys
from pathlib import Path

from tests.checkout import ROOT
from tests.running import Service


def test_service_does_what_its_openapi_document_says(tmp_path: Path) -> None:
    limits = {"CONICOID_PIXEL_LIMIT": "200000", "CONICOID_JOB_PIXEL_LIMIT": "400000", "CONICOID_QUADRIC_LIMIT": "1000"}
    with Service(tmp_path / "store", tmp_path / "log", environment=limits) as service:
        command: list[str | Path] = [
            Path(sys.executable).with_name("st"), "--config-file", ROOT / "tests/api/schemathesis.toml",
            "run", f"{service.url}/openapi.json",
        ]  # fmt: skip
        run = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=tmp_path, check=False
        )
        assert run.returncode == 0, "\n".join(line[:400] for line in run.stdout.splitlines()[-400:])
        assert service.stop() == 0
    assert "Traceback" not in (tmp_path / "log").read_text()
