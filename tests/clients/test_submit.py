"""`conicoid submit` and `conicoid jobs` end to end, on a real service that may be killed meanwhile."""

import json
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conicoid_client import Client
from conicoid_client.command import follow
from conicoid_client.jobs import FrameEnded, Job, Progress
from tests.clients import job_answers
from tests.clients.command import CONICOID, ENVIRONMENT, conicoid, paragraph
from tests.running import Service

CAMERA = {"width": 64, "height": 48, "fov_y": 60}
QUADRICS = [{"shape": "sphere", "center": [0, 0, -3]}]
KEY = "of-the-farm"


def batch(frames: int, **camera: int) -> dict[str, Any]:
    cameras = [{**CAMERA, **camera, "far": 1000 + k} for k in range(frames)]
    return {"conicoid": 1, "quadrics": QUADRICS, "cameras": cameras}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("service")
    with Service(folder / "store", folder / "log", environment={"CONICOID_API_KEYS": f"farm={KEY}"}) as running:
        yield running
        assert running.stop() == 0


@pytest.fixture
def here(tmp_path: Path, service: Service, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a batch of three frames; commands find the service and their key."""
    (tmp_path / "batch.json").write_text(json.dumps(batch(3)))
    monkeypatch.setitem(ENVIRONMENT, "CONICOID_SERVER", service.url)
    monkeypatch.setitem(ENVIRONMENT, "CONICOID_API_KEY", KEY)
    return tmp_path


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


FILES = ["frame-00000.exr", "frame-00001.exr", "frame-00002.exr", "frames.jsonl"]


def test_submit_leaves_the_frames_that_render_would_give(here: Path, service: Service) -> None:
    done = conicoid("submit", "batch.json", "-o", "new/out", cwd=here)
    assert (done.returncode, done.stdout) == (0, b""), done.stderr
    assert b"all 3 frames are in new/out" in done.stderr
    assert names(here / "new/out") == FILES
    with Client(service.url, api_key=KEY) as client:
        for k, camera in enumerate(batch(3)["cameras"]):
            alone = client.render({"conicoid": 1, "quadrics": QUADRICS, "camera": camera})
            assert (here / f"new/out/frame-0000{k}.exr").read_bytes() == alone.exr


def test_a_detached_job_is_found_awaited_and_fetched(here: Path) -> None:
    submitted = conicoid("submit", "batch.json", "--detach", "--idempotency-key", str(here), cwd=here)
    job_id = submitted.stdout.decode().strip()
    again = conicoid("submit", "batch.json", "--detach", "--idempotency-key", str(here), cwd=here)
    assert again.stdout.decode().strip() == job_id
    assert f"conicoid jobs wait {job_id}" in submitted.stderr.decode()
    assert conicoid("jobs", "wait", job_id, cwd=here).returncode == 0
    assert names(here) == ["batch.json"]
    assert conicoid("jobs", "fetch", job_id, "-o", "one", "--frame", "1", cwd=here).returncode == 0
    assert names(here / "one") == ["frame-00001.exr", "frames.jsonl"]
    assert conicoid("jobs", "fetch", job_id, "-o", "all", cwd=here).returncode == 0
    assert names(here / "all") == FILES
    shown = json.loads(conicoid("jobs", "show", job_id, "--json").stdout)
    assert (shown["id"], shown["state"], [frame["number"] for frame in shown["frames"]]) == (
        job_id, "succeeded", [0, 1, 2]
    )  # fmt: skip
    assert "3/3" in conicoid("jobs", "show", job_id).stdout.decode()
    [newest] = json.loads(conicoid("jobs", "list", "--limit", "1", "--json", "--state", "succeeded").stdout)
    assert newest["id"] == job_id
    assert any(job_id in line and "succeeded" in line for line in conicoid("jobs", "list").stdout.decode().split("\n"))
    assert b"had succeeded" in conicoid("jobs", "cancel", job_id).stdout


def test_what_is_there_is_not_written_again(here: Path) -> None:
    assert conicoid("submit", "batch.json", "-o", "out", cwd=here).returncode == 0
    before = [(here / "out" / name).stat().st_ino for name in FILES[:3]]
    (here / "out" / FILES[1]).write_bytes(b"damaged")
    assert conicoid("submit", "batch.json", "-o", "out", cwd=here).returncode == 0
    after = [(here / "out" / name).stat().st_ino for name in FILES[:3]]
    assert [a == b for a, b in zip(before, after, strict=True)] == [True, False, True]


def test_without_its_key_a_client_is_told_what_to_set(here: Path) -> None:
    for key, words in (("", "set CONICOID_API_KEY"), ("wrong", "is CONICOID_API_KEY right")):
        for command in ("submit batch.json -o out", "jobs list", "device"):
            done = conicoid(*command.split(), cwd=here, CONICOID_API_KEY=key)
            assert done.returncode == 1
            assert words in paragraph(done)


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        ("submit batch.json", 2, "-o DIR"),
        ("submit missing.json -o out", 1, "missing.json: no such file"),
        ("submit batch.json -o batch.json", 1, "cannot be written to batch.json"),
        ("submit batch.json -o /proc/self/fdinfo/x", 1, "cannot be written to /proc"),
        ("submit bad.json -o out", 2, "cameras"),
        ("submit batch.json -o out --idempotency-key ü", 1, "ASCII"),
        ("submit batch.json -o out --server nonsense", 2, "URL"),
        ("submit batch.json -o out --server http://127.0.0.1:1", 1, "no answer from http://127.0.0.1:1"),
        ("jobs show 0123", 1, "unknown-job"),
        ("jobs wait ../x", 1, "not a job's id"),
        ("jobs fetch 0123 -o out", 1, "unknown-job"),
        ("jobs cancel 0123", 1, "unknown-job"),
    ],
)
def test_what_goes_wrong_is_one_paragraph(arguments: str, status: int, words: str, here: Path) -> None:
    (here / "bad.json").write_text(json.dumps(batch(0)))
    done = conicoid(*arguments.split(), cwd=here)
    assert done.returncode == status
    assert words in paragraph(done)


@pytest.mark.parametrize("arguments", ["submit batch.json -o out", "jobs list", "jobs wait 0123"])
def test_jobs_need_a_server(arguments: str, here: Path) -> None:
    done = conicoid(*arguments.split(), cwd=here, CONICOID_SERVER="")
    assert done.returncode == 2
    assert "--server URL or CONICOID_SERVER" in paragraph(done)


def test_ctrl_c_leaves_the_job_running_and_says_how_to_go_on(here: Path) -> None:
    (here / "batch.json").write_text(json.dumps(batch(100, width=1000)))
    running = subprocess.Popen(
        [CONICOID, "submit", "batch.json", "-o", "out"], cwd=here, env=ENVIRONMENT, stderr=subprocess.PIPE
    )
    wait_for(here / "out/frame-00000.exr")
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=30)
    assert running.returncode == 130
    job_id = said.decode().split()[1].rstrip(":")
    assert f"conicoid jobs wait {job_id} -o out --server {ENVIRONMENT['CONICOID_SERVER']}" in said.decode()
    assert b"Traceback" not in said
    assert not [name for name in names(here / "out") if name.endswith(".part")]
    assert json.loads(conicoid("jobs", "show", job_id, "--json").stdout)["state"] in ("queued", "running", "succeeded")
    assert conicoid("jobs", "cancel", job_id).returncode == 0
    waited = conicoid("jobs", "wait", job_id, "-o", "out", cwd=here)
    assert waited.returncode == 1
    assert "was cancelled" in paragraph_at_end(waited.stderr)


def test_a_service_that_is_killed_and_started_again_costs_no_frame(tmp_path: Path) -> None:
    (tmp_path / "batch.json").write_text(json.dumps(batch(60, width=1000)))
    with Service(tmp_path / "store", tmp_path / "log") as own:
        running = subprocess.Popen(
            [CONICOID, "submit", "batch.json", "-o", "out", "--server", own.url], cwd=tmp_path, env=ENVIRONMENT,
            stderr=subprocess.PIPE,
        )  # fmt: skip
        wait_for(tmp_path / "out/frame-00000.exr")
        own.kill()
        assert running.poll() is None
        own.start()
        _, said = running.communicate(timeout=60)
        assert running.returncode == 0, said
        assert names(tmp_path / "out") == [*(f"frame-{k:05}.exr" for k in range(60)), "frames.jsonl"]
        with Client(own.url) as client:
            [job] = client.jobs()
            for k in range(60):
                assert (tmp_path / f"out/frame-{k:05}.exr").read_bytes() == client.frame(job.id, k).exr
        assert own.stop() == 0


def test_what_is_shown_never_goes_back(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(follow, "_LINE_EVERY_S", 0.0)
    job = Job.read(job_answers.job(total=9))
    with follow._shown(job) as show:
        for done in (1, 3, 2, 3, 5):
            show(Progress(Job.read(job_answers.job(done=done, total=9))))
            show(FrameEnded.read("1", job_answers.frame(0) | {"frames_done": 1, "frames_failed": 0, "frames_total": 9}))
    said = [line.split(": ")[1] for line in capsys.readouterr().err.splitlines()]
    assert said == ["9 frames", "1 of 9 frames", "3 of 9 frames", "5 of 9 frames"]


def wait_for(path: Path) -> None:
    deadline = time.monotonic() + 60
    while not path.exists():
        assert time.monotonic() < deadline, f"{path} does not come"
        time.sleep(0.02)


def paragraph_at_end(said: bytes) -> str:
    text = said.decode()
    return text[text.index("conicoid: ") :]
