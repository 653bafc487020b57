"""Whatever the bytes, reading an .npz file ends in its arrays, in SceneError or in LimitError, at a bounded cost."""

import io
import struct
import tracemalloc
import zipfile
import zlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from conicoid.document import read_npz
from conicoid.errors import LimitError, SceneError
from tests.malformed import npz
from tests.malformed.case import MOST_BYTES

TYPES = ["<f8", ">f8", "<f4", ">f4", "<f2", "|u1", "<u2", ">u4", "<u8", "|i1", "<i8", "|b1"]
MEMBER = npz.npy(np.zeros(10_000_000))


def read(file: bytes, most_bytes: int = MOST_BYTES) -> dict[str, NDArray[Any]]:
    return read_npz(io.BytesIO(file), most_bytes)


def peak_while_refusing(file: bytes, most_bytes: int) -> int:
    """Bytes allocated at most until the file is refused for its size."""
    tracemalloc.start()
    try:
        with pytest.raises(LimitError):
            read(file, most_bytes)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("shape", [(), (0,), (3,), (0, 3), (2, 3), (2, 4, 4)])
@pytest.mark.parametrize("order", ["C", "F"])
def test_what_numpy_saves_is_read_to_the_last_bit(save: Any, dtype: str, shape: tuple[int, ...], order: Any) -> None:
    values = np.random.default_rng(0).integers(0, 2, shape).astype(dtype, order)
    file = io.BytesIO()
    save(file, values=values, more=values[..., None])
    arrays = read(file.getvalue())
    assert list(arrays) == ["values", "more"]
    assert (arrays["values"].dtype, arrays["values"].shape) == (values.dtype, shape)
    assert arrays["values"].tobytes() == values.tobytes()
    assert arrays["more"].shape == (*shape, 1)


def test_other_writers_headers_are_read() -> None:
    header = "{ 'shape':(2 , ), 'fortran_order' : False,'descr': '<f8' }   \n"
    assert read(npz.npz(("a.npy", npz.headed(header))))["a"].tolist() == [0, 0]
    long_length = b"\x93NUMPY\2\0" + struct.pack("<L", len(npz.HEADER)) + npz.HEADER.encode() + bytes(16)
    assert read(npz.npz(("a.npy", long_length)))["a"].tolist() == [0, 0]


def test_a_file_without_arrays_is_one() -> None:
    assert read(npz.npz()) == {}


def test_the_limit_counts_all_arrays_inflated() -> None:
    file = npz.npz(("a.npy", npz.npy()), ("b.npy", npz.npy()), method=zipfile.ZIP_DEFLATED)
    size = 2 * len(npz.npy())
    assert len(read(file, size)) == 2
    with pytest.raises(LimitError) as caught:
        read(file, size - 1)
    assert (caught.value.limit, caught.value.asked) == (size - 1, size)


def test_a_bomb_is_refused_before_it_is_inflated() -> None:
    bomb = npz.npz(("a.npy", MEMBER), method=zipfile.ZIP_DEFLATED)
    assert len(bomb) < 100_000
    assert peak_while_refusing(bomb, 1_000_000) < 500_000


def test_members_that_share_their_data_count_each() -> None:
    """One deflated stream under a hundred names, as in bombs that fit into a kilobyte."""
    file = io.BytesIO(npz.npz(("0.npy", MEMBER), method=zipfile.ZIP_DEFLATED))
    with zipfile.ZipFile(file, "a") as archive:
        (first,) = archive.infolist()
        for i in range(1, 100):
            shared = zipfile.ZipInfo(f"{i}.npy")
            for field in ("compress_type", "CRC", "compress_size", "file_size", "header_offset"):
                setattr(shared, field, getattr(first, field))
            archive.filelist.append(shared)
        archive._didModify = True  # type: ignore[attr-defined]
    assert peak_while_refusing(file.getvalue(), 10 * len(MEMBER)) < 1_000_000


def test_a_bomb_that_lies_about_its_size_inflates_no_further_than_it_says() -> None:
    bomb = npz.npz(("a.npy", MEMBER), method=zipfile.ZIP_DEFLATED)
    place = bomb.index(b"PK\1\2")
    said = 1_000
    header = npz.headed(npz.HEADER, b"")
    lie = npz.patched(place + 24, struct.pack("<L", said), bomb)
    assert zlib.crc32(MEMBER[:said]) != zlib.crc32(MEMBER)
    assert len(header) < said
    tracemalloc.start()
    with pytest.raises(SceneError):
        read(lie)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2_000_000


def test_a_hundred_thousand_members_are_refused_unread() -> None:
    file = npz.npz(*((f"{i}.npy", b"") for i in range(60_000)))
    with pytest.raises(SceneError, match="more than some thousand arrays"):
        read(file)


SEEDS = [npz.SOUND, npz.DEFLATED, *(case.npz() for case in npz.CASES)]


@given(st.data())
def test_mutated_files_are_read_or_refused(data: st.DataObject) -> None:
    file = bytearray(data.draw(st.sampled_from(SEEDS)))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(file)))
        end = min(len(file), start + data.draw(st.integers(0, 4)))
        tokens = st.sampled_from([b"PK\1\2", b"PK\5\6", b"PK\6\7", b"\xff\xff\xff\xff", bytes(4), b"'<f8'", b"(", b""])
        file[start:end] = data.draw(tokens | st.binary(min_size=end - start, max_size=end - start))
    read_or_refuse(bytes(file))


@given(st.binary(max_size=200))
def test_random_bytes_are_refused(file: bytes) -> None:
    with pytest.raises(SceneError):
        read(file)


@given(st.text("{}()',: descrfotanhp_<8FalseTrue0123", max_size=80))
def test_any_header_is_read_or_refused(header: str) -> None:
    read_or_refuse(npz.npz(("a.npy", npz.headed(header))))
    read_or_refuse(npz.npz(("a.npy", npz.headed(npz.HEADER.replace("(2,)", header)))))


def read_or_refuse(file: bytes) -> None:
    try:
        arrays = read(file)
    except SceneError as error:
        assert all(problem.message.isprintable() for problem in error.problems)  # noqa: PT017
        str(error).encode()
    except LimitError:
        pass
    else:
        assert sum(array.nbytes for array in arrays.values()) <= MOST_BYTES
