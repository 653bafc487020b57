"""Reading OpenEXR files: what is there, and a clear refusal of what is not one."""

import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid_client.exr import ExrError, decode
from tests.clients.exr_files import exr_bytes, half_hit


def test_everything_written_is_read_back() -> None:
    channels = {**half_hit(3, 5), "id": np.arange(15, dtype=np.uint32).reshape(3, 5)}
    image = decode(exr_bytes(channels, at=(7, 2), display=(20, 10), attributes={"conicoid/depth": "planar"}))
    assert image.data_window == (7, 2, 12, 5)
    assert image.display_window == (0, 0, 20, 10)
    assert image.compression == "zip"
    assert image.attributes["conicoid/depth"] == "planar"
    assert image.channels.keys() == channels.keys()
    for name, plane in channels.items():
        np.testing.assert_array_equal(image.channels[name], plane)


@given(st.integers(0, 10_000))
def test_a_file_cut_short_anywhere_is_refused(length: int) -> None:
    whole = exr_bytes(half_hit())
    with pytest.raises(ExrError):
        decode(whole[: length % len(whole)])


@given(st.data())
def test_a_damaged_file_is_read_or_refused_and_nothing_else(data: st.DataObject) -> None:
    damaged = bytearray(exr_bytes(half_hit()))
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    with suppress(ExrError):
        decode(bytes(damaged))


def test_a_header_that_asks_for_too_many_pixels_is_refused_before_they_are_allocated() -> None:
    corner = struct.pack("<4i", 0, 0, 5, 3)
    whole = exr_bytes(half_hit())
    assert corner in whole
    with pytest.raises(ExrError, match="1000000 x 1000000"):
        decode(whole.replace(corner, struct.pack("<4i", 0, 0, 999_999, 999_999)))


def test_refusing_says_nothing_on_the_standard_streams(capfd: pytest.CaptureFixture[str]) -> None:
    whole = exr_bytes(half_hit())
    with pytest.raises(ExrError):
        decode(whole[:-8])
    assert capfd.readouterr() == ("", "")
