"""Broken, strange and hostile `.npz` files beside a sound document."""

import io
import struct
import warnings
import zipfile
from typing import Any

import numpy as np

from tests.malformed.case import Case, sphere

BODY = sphere('"count": 2, "radius": "@a"')


def npy(values: Any = (1.0, 2.0)) -> bytes:
    """An array as a member's bytes."""
    file = io.BytesIO()
    np.lib.format.write_array(file, np.asarray(values), allow_pickle=True)
    return file.getvalue()


def headed(header: str, data: bytes = bytes(16), start: bytes = b"\x93NUMPY\1\0") -> bytes:
    """A member with this header."""
    return start + struct.pack("<H", len(header)) + header.encode("latin-1") + data


def npz(*members: tuple[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    """An archive of members, of which some may have one name."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a name is there twice
        for name, data in members:
            archive.writestr(name, data)
    return file.getvalue()


SOUND = npz(("a.npy", npy()))
DEFLATED = npz(("a.npy", npy()), method=zipfile.ZIP_DEFLATED)
DIRECTORY = SOUND.index(b"PK\1\2")


def patched(place: int, data: bytes, archive: bytes = SOUND) -> bytes:
    return archive[:place] + data + archive[place + len(data) :]


def file(name: str, archive: bytes, pointer: str = "arrays") -> Case:
    return Case(name, BODY, pointer, "scene-npz", False, archive)


def member(name: str, data: bytes) -> Case:
    return file(name, npz(("a.npy", data)), "arrays.a")


HEADER = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }"
SIZES = struct.pack("<2L", len(npy()) + 8, len(npy()) + 8)
FILES = [
    file("empty file of arrays", b""),
    file("file of arrays that is none", b"center,radius\n0,1\n"),
    file("array without an archive", npy()),
    file("archive truncated", SOUND[:-1]),
    file("archive cut in half", SOUND[: len(SOUND) // 2]),
    file("archive's beginning missing", SOUND[40:]),
    file("archive with a comment", SOUND[:-2] + b"\1\0x"),
    file("archive that says it has a comment", patched(len(SOUND) - 2, b"\5\0")),
    file("bytes after the archive", SOUND + b"x"),
    file("checksum wrong", patched(SOUND.index(npy()) + len(npy()) - 1, b"\xff")),
    file("deflated data broken", patched(DEFLATED.index(b"a.npy") + 12, b"\xff\xff\xff", DEFLATED)),
    file("member of another place", patched(DIRECTORY + 42, b"\xff\xff\xff\x7f")),
    file("directory larger than the file", patched(len(SOUND) - 10, b"\xff\xff\0\0")),
    file("directory larger than any", patched(len(SOUND) - 10, b"\xff\xff\xff\xff")),
    file("directory of 64 bits", SOUND[:-22] + b"PK\6\7" + bytes(16) + SOUND[-22:]),
    file("member encrypted", patched(DIRECTORY + 8, b"\1"), "arrays.a"),
    file("member by bzip2", npz(("a.npy", npy()), method=zipfile.ZIP_BZIP2), "arrays.a"),
    file("member by lzma", npz(("a.npy", npy()), method=zipfile.ZIP_LZMA), "arrays.a"),
    file("member by an unknown method", patched(DIRECTORY + 10, b"\x63"), "arrays.a"),
    file("member twice", npz(("a.npy", npy()), ("a.npy", npy())), "arrays.a"),
    file("member in a folder", npz(("b/a.npy", npy())), 'arrays["b/a"]'),
    file("member above the folder", npz(("../a.npy", npy())), 'arrays["../a"]'),
    file("member with a backslash", npz(("b\\a.npy", npy())), 'arrays["b\\\\a"]'),
    file("member at the root", npz(("/a.npy", npy())), 'arrays["/a"]'),
    file("folder", npz(("a/", b"")), 'arrays["a/"]'),
    file("member without a name", npz((".npy", npy())), 'arrays[""]'),
    file("member that is no array", npz(("a.txt", b"1 2")), 'arrays["a.txt"]'),
    file("sizes that the data has not", patched(DIRECTORY + 20, SIZES)),
]  # fmt: skip
MEMBERS = [
    member("empty member", b""),
    member("member of text", b"1 2"),
    member("member of an unknown version", headed(HEADER, start=b"\x93NUMPY\4\0")),
    member("member that ends in its header", headed(HEADER)[:30]),
    member("header longer than any", headed(HEADER + " " * 5000)),
    member("objects", npy(np.array([{}, 1], object))),
    member("records", npy(np.zeros(2, [("x", "f8")]))),
    member("strings", npy(["a", "b"])),
    member("complex numbers", npy([1j, 2])),
    member("long doubles", npy(np.ones(2, np.longdouble))),
    member("dates", npy(np.zeros(2, "M8[s]"))),
    member("header that computes", headed("{'descr': '<f8', 'fortran_order': False, 'shape': (1+1,), }")),
    member("header that calls", headed("{'descr': '<f8', 'fortran_order': __import__('os'), 'shape': (2,), }")),
    member("header without a shape", headed("{'descr': '<f8', 'fortran_order': False, }")),
    member("header with two shapes", headed("{'descr': '<f8', 'shape': (2,), 'shape': (2,), }")),
    member("header with another key", headed("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), 'x': True}")),
    member("header of blanks", headed("{" + " " * 3000 + "'descr'", b"")),
    member("shape negative", headed("{'descr': '<f8', 'fortran_order': False, 'shape': (-2,), }")),
    member("shape too large", headed("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }")),
    member("shape far too large", headed("{'descr': '<f8', 'fortran_order': False, 'shape': (999999999999, 99999), }")),
    member("shape too small", headed("{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }")),
    member("shape of 20 dimensions", headed(f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({'1, ' * 20}), }}")),
]  # fmt: skip
CASES = [*FILES, *MEMBERS]
