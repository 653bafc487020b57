"""Jobs in the client library against answers made up here."""

import hashlib
import io
import json
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest

from conicoid_client import Client, ClientError, Frame, ProblemError, Unreachable
from conicoid_client.frame_files import FrameFiles
from tests.clients.job_answers import ID, Pieces, answer, frame, image, job

Handler = Callable[[httpx.Request], httpx.Response]
KEY = "a-secret-key"


@pytest.fixture(autouse=True)
def naps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The waits that were asked for; none of them is waited."""
    slept: list[float] = []
    monkeypatch.setattr("conicoid_client.connection.time.sleep", slept.append)
    return slept


def client(handler: Handler, api_key: str | None = None) -> Client:
    return Client("http://service.test", api_key=api_key, transport=httpx.MockTransport(handler))


def exr(content: bytes, etag: str, cut: bool = False) -> httpx.Response:
    headers = {"Content-Type": "image/x-exr", "ETag": etag, "Conicoid-Settled": "3"}
    return httpx.Response(200, headers=headers, stream=Pieces([content], cut))


def test_a_submission_whose_answer_is_lost_is_sent_again_under_the_same_key() -> None:
    keys: list[str] = []

    def handle(request: httpx.Request) -> httpx.Response:
        keys.append(request.headers["Idempotency-Key"])
        if len(keys) == 1:
            raise httpx.RemoteProtocolError("cut")
        return answer(job("queued"), 200)

    submitted = client(handle).submit({"conicoid": 1})
    assert (submitted.id, submitted.state, submitted.started, submitted.ended) == (ID, "queued", None, False)
    assert submitted.created is not None
    assert submitted.created.utcoffset() is not None
    assert keys[0] == keys[1]
    client(handle).submit({"conicoid": 1})
    assert keys[2] != keys[1]
    client(handle).submit({"conicoid": 1}, idempotency_key="mine")
    assert keys[3] == "mine"


@pytest.mark.parametrize("key", ["", "two words", "ü", "k" * 256, "a\nb"])
def test_a_key_that_cannot_be_sent_is_refused_at_once(key: str) -> None:
    with pytest.raises(ClientError, match="ASCII"):
        client(lambda _: answer(job())).submit(b"{}", idempotency_key=key)


@pytest.mark.parametrize("job_id", ["", "..", "a/b", "a?b", "é", "x" * 65])
def test_an_id_cannot_lead_elsewhere(job_id: str) -> None:
    service = client(lambda _: answer(job()))
    for call in (service.job, service.cancel, service.wait, lambda i: service.frame(i, 0)):
        with pytest.raises(ClientError, match="id"):
            call(job_id)


@pytest.mark.parametrize("body", [[], {}, None, {"id": 3}, job() | {"frames_total": True}, job() | {"created": "now"}])
def test_an_answer_that_is_not_a_job_is_an_error(body: object) -> None:
    with pytest.raises(ClientError, match="not a job"):
        client(lambda _: answer(body)).job(ID)


def test_every_page_is_read_and_none_from_elsewhere() -> None:
    asked: list[str] = []

    def handle(request: httpx.Request) -> httpx.Response:
        asked.append(str(request.url))
        first = "after" not in request.url.params
        following = "https://elsewhere.test/steal?after=x&state=failed" if first else None
        return answer({"jobs": [job("failed", job_id="a" if first else "b")], "next": following})

    assert [found.id for found in client(handle).jobs("failed")] == ["a", "b"]
    assert asked == [
        "http://service.test/v1/jobs?state=failed",
        "http://service.test/v1/jobs?after=x&state=failed",
    ]


def test_pages_that_go_in_a_circle_end() -> None:
    page = {"frames": [frame(0)], "next": "?first_frame=1"}
    with pytest.raises(ClientError, match="pages"):
        list(client(lambda _: answer(page)).frames(ID))


def test_a_frame_is_an_image_and_304_is_none() -> None:
    def handle(request: httpx.Request) -> httpx.Response:
        assert request.url.path == f"/v1/jobs/{ID}/frames/2"
        if request.headers.get("If-None-Match") == '"tag-2"':
            return httpx.Response(304)
        return exr(image(2), '"tag-2"')

    found = client(handle).frame(ID, 2)
    assert (found.exr, found.etag, found.settled) == (image(2), '"tag-2"', 3)
    assert client(handle).frame(ID, 2, etag='"tag-2"') is None


def test_an_image_that_is_cut_is_read_again_from_its_start() -> None:
    answers = iter([exr(b"image 2ima", '"t"', cut=True), exr(image(2), '"t"')])
    file = io.BytesIO()
    file.write(b"before")
    assert client(lambda _: next(answers)).save_frame(ID, 2, file) == '"t"'
    assert file.getvalue() == b"before" + image(2)


def test_the_key_goes_to_the_service_alone_and_into_no_error() -> None:
    asked: list[httpx.Request] = []

    def handle(request: httpx.Request) -> httpx.Response:
        asked.append(request)
        return httpx.Response(307, headers={"Location": "https://elsewhere.test/"})

    with pytest.raises(ProblemError) as caught:
        client(handle, KEY).device()
    [request] = asked
    assert (request.url.host, request.headers["Authorization"]) == ("service.test", f"Bearer {KEY}")
    assert KEY not in str(caught.value)

    def away(_: httpx.Request) -> httpx.Response:
        raise httpx.ConnectError("refused")

    with pytest.raises(Unreachable) as lost:
        client(away, KEY).device()
    assert KEY not in str(lost.value)
    with pytest.raises(ClientError) as unusable:
        client(away, f"{KEY}\n")
    assert KEY not in str(unusable.value)


def test_nothing_but_the_address_is_shown_of_a_url_with_a_password() -> None:
    with pytest.raises(ClientError) as caught:
        Client("http://me:hush@service.test", transport=httpx.MockTransport(lambda _: httpx.Response(200))).device()
    assert "service.test" in str(caught.value)
    assert "hush" not in str(caught.value)


class Folder:
    """A folder of frames and the requests that filling it took."""

    def __init__(self, path: Path) -> None:
        self.path, self.asked, self.cut = path, list[int](), False

    def save(self, *numbers: int) -> list[bool]:
        files, service = FrameFiles(self.path), client(self._handle)
        return [files.save(service, ID, Frame.read(frame(number))) for number in numbers]

    def _handle(self, request: httpx.Request) -> httpx.Response:
        number = int(request.url.path.rpartition("/")[2])
        self.asked.append(number)
        return exr(image(number)[: 10 if self.cut else None], f'"tag-{number}"', self.cut)


def test_only_what_is_missing_or_damaged_is_fetched(tmp_path: Path) -> None:
    folder = Folder(tmp_path / "new" / "folder")
    assert folder.save(0, 1, 2) == [True, True, True]
    (folder.path / "frame-00001.exr").unlink()
    (folder.path / "frame-00002.exr").write_bytes(image(2)[:-1])
    assert folder.save(0, 1, 2) == [False, True, True]
    assert folder.asked == [0, 1, 2, 1, 2]
    assert [(folder.path / f"frame-0000{k}.exr").read_bytes() for k in range(3)] == [image(k) for k in range(3)]


def test_a_list_that_was_cut_costs_at_most_that_frame(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    folder.save(0, 1)
    listed = tmp_path / "frames.jsonl"
    listed.write_bytes(listed.read_bytes()[:-20])
    assert folder.save(0, 1) == [False, True]
    assert folder.save(0, 1) == [False, False]
    last = json.loads(listed.read_text().splitlines()[-1])
    assert last["sha256"] == hashlib.sha256(image(1)).hexdigest()


def test_a_connection_that_breaks_leaves_no_half_file_and_the_old_one(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    (tmp_path / "frame-00000.exr").write_bytes(b"old")
    folder.cut = True
    with pytest.raises(Unreachable):
        folder.save(0)
    with pytest.raises(Unreachable):
        folder.save(1)
    assert [path.name for path in tmp_path.iterdir()] == ["frame-00000.exr"]
    assert (tmp_path / "frame-00000.exr").read_bytes() == b"old"
