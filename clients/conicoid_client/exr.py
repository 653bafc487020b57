"""Reading an OpenEXR file: its windows, attributes and channels."""

import io
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, redirect_stdout
from dataclasses import dataclass
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from conicoid_client.errors import ClientError

Window = tuple[int, int, int, int]
Mask = NDArray[np.bool_]

DEPTHS = ("Z", "T", "ZBack")

# Header fields of a damaged file can ask for any size; this is four times what a service renders by default.
_MOST_PIXELS = 1 << 28


class ExrError(ClientError):
    """The file is not an OpenEXR file that can be shown."""


@dataclass(frozen=True)
class ExrImage:
    """One single-part, scan-line or tiled image.

    Attributes:
        attributes: every header attribute but the windows, the compression and the channel list.
        channels: name to (h, w) array, rows from the top of the data window; float32, float16 or uint32.
        data_window, display_window: (x0, y0, x1, y1), half-open.
        compression: as the scene document calls it: `zip`, `none`, ...
    """

    attributes: dict[str, Any]
    channels: dict[str, NDArray[Any]]
    data_window: Window
    display_window: Window
    compression: str

    def vector(self, name: str) -> NDArray[Any] | None:
        """Channels name.X, name.Y, name.Z as one (h, w, 3) array; None unless all are there."""
        planes = [self.channels[f"{name}.{axis}"] for axis in "XYZ" if f"{name}.{axis}" in self.channels]
        return np.stack(planes, axis=-1) if len(planes) == 3 else None

    def depth(self) -> NDArray[Any] | None:
        """The first of Z, T and ZBack."""
        return next((self.channels[name] for name in DEPTHS if name in self.channels), None)

    def hits(self) -> Mask | None:
        """Which pixels show a quadric, (h, w): as A or id say, else where N or P are not zero, else by the depth.

        A depth can be inf on a hit and a finite number on a miss, so it decides only in a file that has nothing
        else. None where no channel tells.
        """
        for name in ("A", "id"):
            if name in self.channels:
                return np.asarray(self.channels[name] > 0)
        for name in ("N", "P"):
            if (vector := self.vector(name)) is not None:
                return np.asarray(vector.any(axis=-1))
        if (depth := self.depth()) is None:
            return None
        background = np.float32(self.attributes.get("conicoid/backgroundDepth", np.inf))
        return np.asarray(np.isfinite(depth) & (depth != background))


def decode(data: bytes) -> ExrImage:
    """Read an OpenEXR file.

    Raises:
        ExrError: it is not one, it is damaged, or it is too large to read.
    """
    try:
        header = _open(data, header_only=True).header()
        data_window, display_window = _window(header["dataWindow"]), _window(header["displayWindow"])
        for name, (x0, y0, x1, y1) in (("dataWindow", data_window), ("displayWindow", display_window)):
            if not 0 < (x1 - x0) * (y1 - y0) <= _MOST_PIXELS:
                raise ExrError(f"its {name} is {x1 - x0} x {y1 - y0} pixels; the file is damaged or too large to show")
        channels = {name: channel.pixels for name, channel in _open(data, header_only=False).channels().items()}
    except (RuntimeError, ValueError, KeyError, MemoryError):
        raise ExrError("it is not an OpenEXR file, or it is damaged or incomplete") from None
    x0, y0, x1, y1 = data_window
    if not channels or any(plane.shape != (y1 - y0, x1 - x0) for plane in channels.values()):
        raise ExrError("its channels do not all fill the data window; only plain, unsubsampled images are shown")
    shown = {"channels", "compression", "dataWindow", "displayWindow"}
    return ExrImage(
        attributes={name: value for name, value in header.items() if name not in shown},
        channels=channels,
        data_window=data_window,
        display_window=display_window,
        compression=str(header["compression"].name).removesuffix("_COMPRESSION").lower(),
    )


def _open(data: bytes, *, header_only: bool) -> Any:
    with muted():
        return OpenEXR.File(io.BytesIO(data), separate_channels=True, header_only=header_only)


def _window(corners: Any) -> Window:
    (x0, y0), (x1, y1) = corners
    return int(x0), int(y0), int(x1) + 1, int(y1) + 1


@contextmanager
def muted() -> Iterator[None]:
    """Keep the library's remarks about damaged files to itself: it prints some from Python and some from C."""
    with redirect_stdout(io.StringIO()), ExitStack() as undo:
        if sys.stderr is not None:
            sys.stderr.flush()
            c_stderr = 2
            saved, sink = os.dup(c_stderr), os.open(os.devnull, os.O_WRONLY)
            undo.callback(os.close, saved)
            undo.callback(os.close, sink)
            undo.callback(os.dup2, saved, c_stderr)
            os.dup2(sink, c_stderr)
        yield
