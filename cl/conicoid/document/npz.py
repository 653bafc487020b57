"""The arrays beside a document: an `.npz` file, which is a ZIP archive of `.npy` files, read as hostile text is.

Nothing in it is executed or written anywhere, and nothing is inflated before its size is known to be allowed. The
formats: APPNOTE.TXT of PKWARE for the archive, `numpy.lib.format` for its members.
"""

import re
import struct
import zlib
from io import BufferedIOBase, RawIOBase
from math import prod
from typing import IO, Any, Final, Literal
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from conicoid.document.problems import key_place, show
from conicoid.errors import LimitError, Problem, SceneError

_CHUNK: Final = 1 << 18
_SUFFIX: Final = ".npy"
_ENCRYPTED: Final = 0x1  # bit of a member's flags

# The record at an archive's end, and the longest directory of members that is read: some 10,000 of them.
_END: Final = struct.Struct("<4s4H2LH")
_END_MARK: Final = b"PK\5\6"
_ZIP64_LOCATOR_MARK: Final = b"PK\6\7"
_ZIP64_LOCATOR_SIZE: Final = 20
_MOST_DIRECTORY: Final = 1 << 20

_MAGIC: Final = b"\x93NUMPY"
_LENGTHS: Final = {
    b"\1\0": struct.Struct("<H"),
    b"\2\0": struct.Struct("<L"),
    b"\3\0": struct.Struct("<L"),
}  # by version
_MOST_HEADER: Final = 1 << 12
# Of a header without its blanks, which then matches in one way only.
_ITEM: Final = rb"'(\w+)':('[^']*'|True|False|\((?:\d{1,15},){0,8}(?:\d{1,15})?\))"
_HEADER: Final = re.compile(rb"\{" + rb",".join([_ITEM] * 3) + rb",?\}")
_TYPE: Final = re.compile(r"[<>|=]?(?:f[248]|[iu][1248]|b1)")

# What reading a broken archive or a broken stream in one raises.
_BROKEN: Final = (
    BadZipFile,
    EOFError,
    NotImplementedError,
    OSError,
    RuntimeError,
    ValueError,
    struct.error,
    zlib.error,
)


def read_npz(file: RawIOBase | BufferedIOBase, most_bytes: int) -> dict[str, NDArray[Any]]:
    """The arrays of an `.npz` file by name, of real, integer or boolean numbers of any byte order.

    Args:
        file: a seekable file, read from its beginning to its end.
        most_bytes: of all arrays together, inflated.

    Raises:
        SceneError: it is no such file, or holds anything else; places are as in `arrays.center`.
        LimitError: its arrays are larger than `most_bytes`; they have not been inflated.
    """
    try:
        _check_end(file)
        with ZipFile(file) as archive:
            members = archive.infolist()
            names = _names(members)
            asked = sum(member.file_size for member in members)
            if asked > most_bytes:
                raise LimitError("bytes of arrays", most_bytes, asked)
            return {name: _array(archive, member, name) for name, member in zip(names, members, strict=True)}
    except _BROKEN as error:
        raise _wrong(
            "arrays", f"not an .npz file that can be read ({_reason(error)}); write it with numpy.savez"
        ) from None


def _check_end(file: RawIOBase | BufferedIOBase) -> None:
    """Refuse an archive whose directory of members would take more memory than any honest one."""
    size = file.seek(0, 2)
    file.seek(max(0, size - _END.size - _ZIP64_LOCATOR_SIZE))
    tail = file.read()
    if size < _END.size:
        raise BadZipFile("too short")
    mark, *_, directory_size, _, comment_size = _END.unpack(tail[-_END.size :])
    if mark != _END_MARK or comment_size:
        raise BadZipFile("no archive ends where the file ends")
    if tail[: -_END.size].startswith(_ZIP64_LOCATOR_MARK) or directory_size > _MOST_DIRECTORY:
        raise BadZipFile("larger than 2 GiB, or of more than some thousand arrays")


def _names(members: list[ZipInfo]) -> list[str]:
    """The arrays' names, each member's without its suffix."""
    names: list[str] = []
    for member in members:
        name = member.filename.removesuffix(_SUFFIX)
        place = key_place("arrays", name)
        if not name or name == member.filename or "/" in name or "\\" in name:
            raise _wrong(place, f"{show(member.filename)} is not the name of an array; write the file with numpy.savez")
        if name in names:
            raise _wrong(place, "in the file more than once; give it once")
        if member.flag_bits & _ENCRYPTED or member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
            raise _wrong(place, "encrypted, or not compressed by deflate; write it with numpy.savez_compressed")
        names.append(name)
    return names


def _array(archive: ZipFile, member: ZipInfo, name: str) -> NDArray[Any]:
    """One array, read into memory of its own in pieces."""
    place = key_place("arrays", name)
    with archive.open(member) as stream:
        dtype, order, shape = _described(_header(stream, place), place)
        size, held = dtype.itemsize * prod(shape), member.file_size - stream.tell()
        if size != held:
            raise _wrong(place, f"says {dtype} of shape {shape}, {size} bytes, but has {held}; write the file anew")
        data, filled = np.empty(size, np.uint8), 0
        while piece := stream.read(_CHUNK):  # to the end, where the checksum is compared
            data[filled : filled + len(piece)] = np.frombuffer(piece, np.uint8)
            filled += len(piece)
    if filled != size:
        raise _wrong(place, f"ends after {filled} of {size} bytes; write the file anew")
    return data.view(dtype).reshape(shape, order=order)


def _header(stream: IO[bytes], place: str) -> bytes:
    """The description at the beginning of an `.npy` file."""
    magic, length = stream.read(len(_MAGIC)), _LENGTHS.get(stream.read(2))
    if magic == _MAGIC and length:
        (size,) = length.unpack(stream.read(length.size))
        if size <= _MOST_HEADER:
            return stream.read(size)
    raise _wrong(place, "not an array as NumPy writes it; write the file with numpy.savez")


def _described(header: bytes, place: str) -> tuple[np.dtype[Any], Literal["C", "F"], tuple[int, ...]]:
    """Type, memory order and shape of an array, without evaluating the Python text that says so."""
    match = _HEADER.fullmatch(b"".join(header.split()))
    words = [word.decode("latin-1") for word in match.groups()] if match else []
    items = dict(zip(words[::2], words[1::2], strict=True))
    if items.keys() != {"descr", "fortran_order", "shape"}:
        raise _wrong(place, "not one plain array of numbers; give one without fields")
    described, order, sizes = items["descr"].strip("'"), items["fortran_order"], items["shape"].strip("()")
    if not _TYPE.fullmatch(described):
        raise _wrong(place, f"{show(described)} is not a type of numbers that is read; convert it to float64")
    shape = tuple(int(size) for size in sizes.split(",") if size)
    return np.dtype(described), "F" if order == "True" else "C", shape


def _reason(error: Exception) -> str:
    """A library's own words in one printable line."""
    words = str(error) or type(error).__name__
    return "".join(c for c in words[:100] if c.isascii() and c.isprintable())


def _wrong(place: str, message: str) -> SceneError:
    return SceneError([Problem(place, message, "scene-npz")])
