"""Files in a bucket of a real S3-compatible server."""

import os
import time
from threading import Timer

import httpx
import pytest

from conicoid_service.blob import Blob
from conicoid_service.errors import StoreError
from conicoid_service.jobs import bucket as module
from conicoid_service.jobs.bucket import Bucket
from tests.farm.proxy import Proxy
from tests.farm.servers import Servers

NOW_MS = 2**60


@pytest.fixture
def bucket(servers: Servers, monkeypatch: pytest.MonkeyPatch) -> Bucket:
    for name, value in servers.store.access().items():
        monkeypatch.setenv(name, value)
    return Bucket(f"{servers.store.create()}/some/prefix/", "images", "image/x-exr")


@pytest.fixture
def written(bucket: Bucket) -> bytes:
    """Larger than what is sent at a time."""
    data = os.urandom(12_000_000)
    with Blob.of(data) as blob:
        bucket.write("abcd", blob)
    return data


def content(bucket: Bucket, name: str) -> bytes | None:
    blob = bucket.open(name)
    if blob is None:
        return None
    with blob:
        return blob.read()


def test_file_comes_back_as_it_was_written(bucket: Bucket, written: bytes) -> None:
    assert content(bucket, "abcd") == written
    assert list(bucket.names(NOW_MS)) == ["abcd"]


def test_file_is_replaced_and_removed(bucket: Bucket, written: bytes) -> None:
    with Blob.of(b"shorter") as blob:
        bucket.write("abcd", blob)
    assert content(bucket, "abcd") == b"shorter" != written
    bucket.remove("abcd")
    bucket.remove("abcd")
    assert content(bucket, "abcd") is None
    assert list(bucket.names(NOW_MS)) == []


def test_young_file_needs_not_be_written_again(bucket: Bucket, written: bytes) -> None:
    assert written
    assert bucket.touch("abcd")
    assert not bucket.touch("none")
    a_minute_ago_ms = round(time.time() * 1e3) - 60_000
    assert list(bucket.names(a_minute_ago_ms)) == []
    assert [bucket.is_older("abcd", than_ms) for than_ms in (a_minute_ago_ms, NOW_MS)] == [False, True]
    assert not bucket.is_older("none", NOW_MS)


def test_link_gives_the_file_to_anybody_and_its_like_without_the_signature_does_not(
    bucket: Bucket, written: bytes
) -> None:
    link = bucket.link("abcd", 60)
    assert link is not None
    assert httpx.get(link).content == written
    assert httpx.get(link.partition("?")[0]).status_code in (400, 403)
    assert httpx.get(link.replace("abcd", "abce")).status_code in (400, 403)


def test_missing_bucket_is_a_refusal_that_does_not_tell_where_it_is(servers: Servers, bucket: Bucket) -> None:
    assert bucket
    missing = Bucket("s3://none", "images", "image/x-exr")
    with Blob.of(b"") as blob, pytest.raises(OSError, match="the object store fails") as refused:
        missing.write("abcd", blob)
    assert str(servers.store.port) not in str(refused.value)


def test_file_is_read_for_as_long_as_bytes_come_and_no_longer(
    servers: Servers, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_ANSWER_S", 1)
    monkeypatch.setattr(module, "_STALL_S", 1)
    data = os.urandom(6_000_000)  # more than comes in four attempts of a second
    with Proxy(servers.store.port) as proxy:
        for name, value in servers.store.access(f"http://{proxy.address}:{proxy.port}").items():
            monkeypatch.setenv(name, value)
        bucket = Bucket(servers.store.create(), "images", "image/x-exr")
        with Blob.of(data) as blob:
            bucket.write("abcd", blob)
        proxy.slow(1_000_000)
        assert content(bucket, "abcd") == data
        Timer(1.5, proxy.stall).start()
        began = time.monotonic()
        with pytest.raises(OSError, match="the object store fails"):
            bucket.open("abcd")
        assert time.monotonic() - began < 10


def test_url_that_names_no_store_is_refused() -> None:
    with pytest.raises(StoreError, match="is no object store that can be used"):
        Bucket("what://bucket", "images", "image/x-exr")
