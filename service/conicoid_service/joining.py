"""Bands of a frame joined to its file: the bytes that it would have in one piece."""

from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO

import numpy as np
import OpenEXR
import orjson
from numpy.typing import NDArray

from conicoid import __version__
from conicoid.canonical import view_hash
from conicoid.data_window import tight_window
from conicoid.scene import PLANES, Camera, Output
from conicoid_service import exr
from conicoid_service.bands import Window, band_view
from conicoid_service.errors import BandsError


def join(stream: BinaryIO, camera: Camera, output: Output, bands: Sequence[BinaryIO], quadrics_hash: str) -> None:
    """Write the frame that its bands make, to an empty, seekable stream.

    The frame's planes and one band's are in memory, no more. Damage is told where the file format can: it has a
    checksum for rows that zip made smaller, and none for those that it could not.

    Args:
        stream: where the bytes go.
        camera: the frame's own.
        output: the frame's own.
        bands: files that were rendered with `bands.band_view`, from the top, seekable; cut at any row.
        quadrics_hash: of the quadrics that the frame shows.
    Raises:
        BandsError: they are damaged, of another frame, not all there or not in order.
    """
    frame = _Frame(camera, output)
    for number, (band, crop) in enumerate(_in_order(camera, output, bands, quadrics_hash), 1):
        frame.add(f"band {number} of {len(bands)}", band, crop)
    planes, window = frame.cut()
    exr.write(stream, planes, window, camera, output, view_hash(quadrics_hash, camera, output))


def _in_order(
    camera: Camera, output: Output, bands: Sequence[BinaryIO], quadrics_hash: str
) -> Iterator[tuple[BinaryIO, Window]]:
    """The bands and their windows; the headers of all of them are looked at before the first is given."""
    windows, (left, row, right, end) = list[Window](), camera.crop
    for number, band in enumerate(bands, 1):
        name = f"band {number} of {len(bands)}"
        window, version, scene_hash = _header(name, band)
        if version != __version__:
            raise BandsError(f"{name} was rendered by Conicoid {version}, this is {__version__}; render it again")
        expected = view_hash(quadrics_hash, *band_view(camera, output, window))
        if (scene_hash, *window[::2]) != (expected, left, right):
            raise BandsError(f"{name} is of another frame, scene or output; render it again")
        if window[1] != row:
            raise BandsError(
                f"{name} begins at row {window[1]} and not at {row}; give all bands, once each, from the top"
            )
        windows.append(window)
        row = window[3]
    if row != end:
        raise BandsError(f"the bands end at row {row} and the frame at {end}; give all of them")
    return zip(bands, windows, strict=True)


def _header(name: str, band: BinaryIO) -> tuple[Window, str, str]:
    """The window, conicoid's version and the scene's hash; the window is the one that the hash is made of."""
    try:
        header = _open(band, header_only=True).header()
        x0, y0, x1, y1 = orjson.loads(header["conicoid/camera"])["crop"]
        return (int(x0), int(y0), int(x1), int(y1)), header["conicoid/version"], header["conicoid/sceneHash"]
    except (RuntimeError, ValueError, KeyError, TypeError):
        raise BandsError(f"{name} is damaged, or no band at all; render it again") from None


def _open(band: BinaryIO, *, header_only: bool) -> Any:
    band.seek(0)
    return OpenEXR.File(band, separate_channels=True, header_only=header_only)


class _Frame:
    """The planes of a frame, filled band by band."""

    def __init__(self, camera: Camera, output: Output) -> None:
        self._crop, self._tight = camera.crop, output.data_window == "tight"
        x0, y0, x1, y1 = camera.crop
        self._rows, self._columns = np.zeros(y1 - y0, dtype=np.bool_), np.zeros(x1 - x0, dtype=np.bool_)
        normals = np.float16 if output.half_normals else np.float32
        names = [name for channel in output.channels for name in PLANES.get(channel, (channel,))]
        self._planes: dict[str, NDArray[Any]] = {
            name: np.empty(
                (y1 - y0, x1 - x0), np.uint32 if name == "id" else normals if name.startswith("N.") else np.float32
            )
            for name in names
        }

    def add(self, name: str, band: BinaryIO, window: Window) -> None:
        """Copies a band's planes to their place.

        Raises:
            BandsError: it is damaged.
        """
        rows = slice(window[1] - self._crop[1], window[3] - self._crop[1])
        try:
            channels = _open(band, header_only=False).channels()
            for plane, whole in self._planes.items():
                whole[rows] = _checked(channels[plane].pixels, window, whole.dtype)
            if self._tight:
                mask = _checked(channels["A"].pixels, window, np.dtype(np.float32))
                self._rows[rows] = mask.any(axis=1)
                self._columns |= mask.any(axis=0)
        except (RuntimeError, ValueError, KeyError, TypeError):
            raise BandsError(f"{name} is damaged; render it again") from None

    def cut(self) -> tuple[dict[str, NDArray[Any]], Window]:
        """The planes of the data window, and the window; call it once, for planes are given up one by one."""
        if not self._tight:
            return self._planes, self._crop
        window = tight_window(self._crop, self._rows, self._columns)
        x0, y0 = self._crop[:2]
        rows, columns = slice(window[1] - y0, window[3] - y0), slice(window[0] - x0, window[2] - x0)
        for name in self._planes:
            self._planes[name] = np.ascontiguousarray(self._planes[name][rows, columns])
        return self._planes, window


def _checked(pixels: NDArray[Any], window: Window, dtype: Any) -> NDArray[Any]:
    """A band's plane, which is in full precision.

    Raises:
        ValueError: it is of another type or size.
    """
    x0, y0, x1, y1 = window
    expected = np.uint32 if dtype == np.uint32 else np.float32
    if pixels.dtype != expected or pixels.shape != (y1 - y0, x1 - x0):
        raise ValueError("a band's header contradicts itself")
    return pixels
