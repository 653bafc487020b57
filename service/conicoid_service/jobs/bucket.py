"""Files of the job store as objects of a bucket: S3, or another store that obstore speaks to."""

import errno
import logging
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from typing import TYPE_CHECKING, Any, Final

import obstore
from obstore.exceptions import BaseError
from obstore.store import from_url

from conicoid_service.blob import CHUNK, Blob
from conicoid_service.errors import StoreError

if TYPE_CHECKING:  # in its stubs alone
    from obstore.store import ClientConfig, RetryConfig

# As old as this a file is written once more rather than trusted to stay, see `Files.touch`.
_YOUNG_S: Final = 1800.0
_CONNECT_S: Final = 5
_ANSWER_S: Final = 60  # for a whole request; a large file is written in several
_BODY_S: Final = 600  # for a whole file that is read
_STALL_S: Final = 30  # for the next bytes of it
_AT_ONCE: Final = 5 << 20
_PARTS_AT_ONCE: Final = 4  # of 5 MiB, so that 350 kB a second are enough
_RETRY: "Final[RetryConfig]" = {"max_retries": 3, "retry_timeout": timedelta(seconds=20)}

logger = logging.getLogger(__name__)


class Bucket:
    """`jobs.files.Files` below a prefix of a bucket.

    Where the store is and how it is entered is the usual variables' to say: `AWS_ENDPOINT_URL`, `AWS_ACCESS_KEY_ID`...

    Args:
        url: `s3://bucket/prefix`, `gs://...`, `az://...`.
        kind: what comes behind the prefix.
        media_type: of all of them.
    Raises:
        StoreError: the URL or the variables do not name a store.
    """

    def __init__(self, url: str, kind: str, media_type: str) -> None:
        self._attributes = {"Content-Type": media_type}
        place = f"{url.rstrip('/')}/{kind}"
        try:
            self._store = _opened(place, {"timeout": f"{_ANSWER_S}s"})
            self._reader = _opened(place, {"timeout": f"{_BODY_S}s", "read_timeout": f"{_STALL_S}s"})
        except (BaseError, ValueError) as error:
            raise StoreError(f"{url}: is no object store that can be used ({_reason(error)})") from None

    def write(self, name: str, blob: Blob) -> None:
        """As `Files.write`: an object is there as a whole, or not."""
        with blob.shared() as own, _as_os_error():
            own.file.seek(0)
            # Of a file the library reads its first part to learn whether there is another.
            data = own.file if len(own) > _AT_ONCE else own.read()
            try:
                obstore.put(self._store, _key(name), data, attributes=self._attributes, max_concurrency=_PARTS_AT_ONCE)
            except FileNotFoundError as error:
                raise BaseError("there is no such bucket") from error

    def open(self, name: str) -> Blob | None:
        """As `Files.open`: a copy in memory."""
        blob = Blob()
        try:
            with _as_os_error():
                for chunk in obstore.get(self._reader, _key(name)).stream(min_chunk_size=CHUNK):
                    blob.append(memoryview(chunk))
        except BaseException as error:
            blob.close()
            if isinstance(error, FileNotFoundError):
                return None
            raise
        return blob

    def size(self, name: str) -> int | None:
        """As `Files.size`."""
        try:
            with _as_os_error():
                return int(obstore.head(self._store, _key(name))["size"])
        except FileNotFoundError:
            return None

    def remove(self, name: str) -> None:
        """As `Files.remove`."""
        try:
            with _as_os_error():
                obstore.delete(self._store, _key(name))
        except FileNotFoundError:
            pass

    def touch(self, name: str) -> bool:
        """As `Files.touch`."""
        written_s = self._written_s(name)
        return written_s is not None and time.time() - written_s < _YOUNG_S

    def names(self, older_than_ms: int) -> Iterator[str]:
        """As `Files.names`; a thousand for each request to the store."""
        with _as_os_error():
            for some in obstore.list(self._store):
                for one in some:
                    if one["last_modified"].timestamp() * 1e3 < older_than_ms:
                        yield one["path"].rpartition("/")[2]

    def is_older(self, name: str, than_ms: int) -> bool:
        """As `Files.is_older`."""
        written_s = self._written_s(name)
        return written_s is not None and written_s * 1e3 < than_ms

    def sweep(self, older_than_ms: int) -> None:
        """Nothing: what is half written cannot be seen, and a rule of the bucket ends it."""

    def link(self, name: str, seconds: float) -> str | None:
        """A signed URL, where the store knows them."""
        try:
            return str(obstore.sign(self._store, "GET", _key(name), timedelta(seconds=seconds)))
        except (BaseError, TypeError):
            return None

    def _written_s(self, name: str) -> float | None:
        try:
            with _as_os_error():
                return float(obstore.head(self._store, _key(name))["last_modified"].timestamp())
        except FileNotFoundError:
            return None


def _opened(place: str, client: "ClientConfig") -> Any:
    client["connect_timeout"] = f"{_CONNECT_S}s"
    if os.environ.get("AWS_ALLOW_HTTP", "").lower() in ("true", "1"):  # options given here hide this variable
        client["allow_http"] = True
    return from_url(place, client_options=client, retry_config=_RETRY)


def _key(name: str) -> str:
    return f"{name[:2]}/{name}"


@contextmanager
def _as_os_error() -> Iterator[None]:
    """Errors of the store as those that a disk has; what they say of URLs is for the log."""
    try:
        yield
    except FileNotFoundError:
        raise
    except BaseError as error:
        logger.warning("the object store: %s", _reason(error))
        raise OSError(errno.EIO, "the object store fails") from error


def _reason(error: Exception) -> str:
    """The first line of an error's message."""
    return str(error).strip().partition("\n")[0][:200]
