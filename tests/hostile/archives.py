"""Arrays that are bombs, lies, or no arrays."""

import io
import pickle
import struct
import zlib
from zipfile import ZIP_BZIP2, ZIP_DEFLATED, ZIP_LZMA, ZIP_STORED, ZipFile, ZipInfo

from tests.hostile.case import Hostile, multipart, part

SCENE = (
    b'{"conicoid": 1, "quadrics": [{"shape": "sphere", "count": 2, "center": "@c"}], '
    b'"camera": {"width": 4, "height": 4, "fov_y": 40}}'
)
GIGABYTE = 1 << 30


def npy(header: str, data: bytes = b"", version: bytes = b"\x01\x00", length: int | None = None) -> bytes:
    text = header.encode() + b"\n"
    size = len(text) if length is None else length
    return (
        b"\x93NUMPY" + version + (struct.pack("<H", size) if version[0] == 1 else struct.pack("<I", size)) + text + data
    )


def header(shape: str = "(2, 3)", dtype: str = "'<f8'", order: str = "False") -> str:
    return f"{{'descr': {dtype}, 'fortran_order': {order}, 'shape': {shape}, }}"


GOOD = npy(header(), bytes(48))


def archive(members: list[tuple[str, bytes]], kind: int = ZIP_DEFLATED) -> bytes:
    file = io.BytesIO()
    with ZipFile(file, "w", kind) as zipped:
        for name, content in members:
            zipped.writestr(ZipInfo(name), content, kind)
    return file.getvalue()


def zeros(size: int) -> bytes:
    """A deflated member of zeros, whose size the directory tells truly."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    head, checksum, pieces = npy(header(f"({(size - 100) // 8},)")), 0, []
    for content in (head, *[bytes(1 << 20)] * ((size - len(head)) >> 20)):
        checksum = zlib.crc32(content, checksum)
        pieces.append(packer.compress(content))
    length = len(head) + ((size - len(head)) >> 20 << 20)
    return entry(b"c.npy", b"".join([*pieces, packer.flush()]), length, checksum)


def entry(
    name: bytes, packed: bytes, size: int, checksum: int, method: int = 8, flags: int = 0, copies: int = 1
) -> bytes:
    """An archive of one member, whose numbers may be lies; its directory may name it several times."""
    packed_size = len(packed)
    local = struct.pack("<IHHHHHIIIHH", 0x04034B50, 20, flags, method, 0, 0, checksum, packed_size, size, len(name), 0)
    body = local + name + packed
    central = b"".join(
        struct.pack(
            "<IHHHHHHIIIHHHHHII", 0x02014B50, 20, 20, flags, method, 0, 0, checksum, packed_size, size,
            len(name) + len(str(copy)), 0, 0, 0, 0, 0, 0,
        ) + name + str(copy).encode()
        if copies > 1 else
        struct.pack(
            "<IHHHHHHIIIHHHHHII", 0x02014B50, 20, 20, flags, method, 0, 0, checksum, packed_size, size, len(name),
            0, 0, 0, 0, 0, 0,
        ) + name
        for copy in range(copies)
    )  # fmt: skip
    end = struct.pack("<IHHHHIIH", 0x06054B50, 0, 0, copies & 0xFFFF, copies & 0xFFFF, len(central), len(body), 0)
    return body + central + end


def deflated(content: bytes) -> bytes:
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return packer.compress(content) + packer.flush()


def with_array(content: bytes) -> bytes:
    return archive([("c.npy", content)])


ARRAYS = {
    "a gigabyte of zeros": zeros(GIGABYTE),
    "a gigabyte that says it is 100 bytes": entry(b"c.npy", deflated(bytes(64 << 20)), 100, 0),
    "100 bytes that say they are 4 gigabytes": entry(b"c.npy", deflated(GOOD), 0xFFFFFFFE, 0),
    "a wrong checksum": entry(b"c.npy", deflated(GOOD), len(GOOD), 1),
    "one member by 60,000 names": entry(b"c", deflated(GOOD), len(GOOD), zlib.crc32(GOOD), copies=60_000),
    "an encrypted member": entry(b"c.npy", deflated(GOOD), len(GOOD), zlib.crc32(GOOD), flags=1),
    "an unknown method": entry(b"c.npy", deflated(GOOD), len(GOOD), zlib.crc32(GOOD), method=99),
    "50,000 members": archive([(f"m{i}.npy", b"") for i in range(50_000)]),
    "an archive in an archive": archive([("c.npy", archive([("c.npy", GOOD)]))]),
    "bzip2": archive([("c.npy", GOOD)], ZIP_BZIP2),
    "lzma": archive([("c.npy", GOOD)], ZIP_LZMA),
    "a path upwards": archive([("../../etc/passwd.npy", GOOD)]),
    "an absolute path": archive([("/etc/passwd.npy", GOOD)], ZIP_STORED),
    "a name with NUL": archive([("c\0.npy", GOOD)]),
    "a name with lines": archive([("c\r\nX-Evil: 1.npy", GOOD)]),
    "a pickle": with_array(pickle.dumps(print)),
    "an array of objects": with_array(npy(header(dtype="'|O'"), pickle.dumps([print]))),
    "a header that calls": with_array(npy("__import__('os').abort()")),
    "a header in a header": with_array(npy(header(dtype="[('a', '<f8'), ('b', '|O')]"), bytes(48))),
    "a deep header": with_array(npy("(" * 60_000)),
    "a header longer than the file": with_array(npy(header(), length=60_000)),
    "a header of 4 gigabytes": with_array(npy(header(), version=b"\x02\x00", length=0xFFFFFFFF)),
    "an unknown version": with_array(npy(header(), bytes(48), version=b"\x09\x00")),
    "a shape beyond 64 bits": with_array(npy(header(shape="(4294967296, 4294967296)"))),
    "a negative shape": with_array(npy(header(shape="(-2, 3)"), bytes(48))),
    "a shape of 10,000 axes": with_array(npy(header(shape=f"({'1,' * 10_000})"), bytes(8))),
    "a shape of many digits": with_array(npy(header(shape=f"({'9' * 10_000},)"))),
    "data that is not there": with_array(npy(header(shape="(1000000, 3)"))),
    "more data than said": with_array(GOOD + bytes(1000)),
    "NaN and infinity": with_array(npy(header(), struct.pack("<6d", *[float("nan")] * 3, *[float("inf")] * 3))),
    "an end alone": b"PK\x05\x06" + bytes(18),
    "an end that lies": b"PK\x05\x06" + b"\xff" * 18,
    "an archive cut short": archive([("c.npy", GOOD)])[:-30],
    "no archive": b"x" * 1000,
    "nothing": b"",
}

CASES = [
    Hostile(
        f"arrays: {name}", multipart(part(b"scene", SCENE) + part(b"arrays", content) + b"--b--\r\n"), (400, 413, 422)
    )
    for name, content in ARRAYS.items()
]
