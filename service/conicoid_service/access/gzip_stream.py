"""A gzip body, inflated as it arrives, in steps small enough for the event loop."""

import zlib
from collections.abc import Iterator
from typing import Final

from conicoid_service.errors import CompressedDataError

_STEP: Final = 1 << 20  # bytes inflated at once, which takes some milliseconds
_GZIP: Final = 16 + zlib.MAX_WBITS  # zlib's word for a gzip header and trailer


class GzipStream:
    """Inflates one or more gzip members, as RFC 1952 lets a file have them."""

    def __init__(self) -> None:
        self._member = zlib.decompressobj(_GZIP)

    def inflate(self, data: bytes) -> Iterator[bytes]:
        """What `data`, the next bytes of the body, inflate to, at most 1 MiB at a time; never empty pieces.

        Raises:
            CompressedDataError: they are not gzip.
        """
        while data:
            if self._member.eof:
                self._member = zlib.decompressobj(_GZIP)
            try:
                piece = self._member.decompress(data, _STEP)
            except zlib.error:
                raise CompressedDataError("the body is not gzip, or broken; send it as it is") from None
            data = self._member.unconsumed_tail or self._member.unused_data
            if piece:
                yield piece

    def finish(self) -> None:
        """Check that the last member is complete.

        Raises:
            CompressedDataError: the body ends before it does.
        """
        if not self._member.eof:
            raise CompressedDataError("the gzip body ends too early; send all of it")
