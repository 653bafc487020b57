"""`conicoid bench service`: documents that are new to a service, and all of it from end to end on a tiny image."""

import json
from pathlib import Path
from typing import Any

import pytest

from conicoid.canonical import quadrics_hash
from conicoid.document import parse
from conicoid_bench.service.encoding import COMPRESSIONS
from conicoid_bench.service.run import Documents
from conicoid_bench.service.server import Connection, ServiceFailed, serving
from conicoid_bench.service.table import markdown
from tests.checkout import ROOT
from tests.clients.command import conicoid

SCENE: dict[str, Any] = {
    "conicoid": 1,
    "quadrics": [{"shape": "sphere", "center": [0, 0, -3]}, {"shape": "plane", "center": [0, 0, -9]}],
    "camera": {"width": 40, "height": 30, "fov_y": 60},
}


def test_every_document_shows_the_same_and_is_new_to_the_service() -> None:
    documents = Documents(json.dumps(SCENE).encode())
    scenes = [parse(documents.next("zstd")).resolve() for _ in range(3)]
    assert len({quadrics_hash(scene.quadrics) for scene in scenes}) == 3
    assert {scene.output.compression for scene in scenes} == {"zstd"}
    assert len({scene.quadrics.radii.tobytes() + scene.quadrics.shape.tobytes() for scene in scenes}) == 1


def test_a_service_that_cannot_start_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CONICOID_THREADS", "many")
    with pytest.raises(ServiceFailed, match="CONICOID_THREADS"), serving(None):
        pass


def test_an_answer_that_is_a_problem_is_told() -> None:
    with serving(None) as port:
        connection = Connection(port)
        with pytest.raises(ServiceFailed, match="scene-json"):
            connection.render(b"{")
        connection.close()


def test_a_scene_is_measured_from_end_to_end(tmp_path: Path) -> None:
    (tmp_path / "scene.json").write_text(json.dumps(SCENE))
    done = conicoid("bench", "service", "scene.json", "-o", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    record, table = (Path(tmp_path, line) for line in done.stdout.decode().split())
    results = json.loads(record.read_bytes())
    assert results["compressions"].keys() == COMPRESSIONS.keys()
    for row in results["compressions"].values():
        assert row["ms"] > row["stages_ms"]["encode"] > 0
        assert row["rest_ms"] > 0 < row["openexr_ms"]
        assert row["frames_per_s"] > 0
    assert 0 < results["not_modified_ms"] < results["start_ms"]
    assert table.read_text("utf-8") == markdown(results)


def test_a_scene_that_is_wrong_is_bad_usage(tmp_path: Path) -> None:
    (tmp_path / "scene.json").write_text("{}")
    done = conicoid("bench", "service", "scene.json", "-o", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(b"conicoid: scene.json: ")


def test_the_documented_tables_are_those_of_the_recorded_results() -> None:
    page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    records = sorted((ROOT / "bench" / "results").glob("service-*.json"))
    assert records
    for record in records:
        assert markdown(json.loads(record.read_bytes())) in page
