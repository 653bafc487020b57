"""An image says exactly what the frame holds, to OpenEXR and OpenImageIO alike, and always in the same bytes."""

import hashlib
import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any, BinaryIO, get_args

import numpy as np
import OpenEXR
import OpenImageIO
import pytest
from numpy.typing import NDArray

from conicoid import __version__
from conicoid.engine import Frame
from conicoid.scene import Channel, Compression, Scene
from conicoid_service import exr
from conicoid_service.blob import Blob
from tests.checkout import ROOT
from tests.service.scenes import frame, scene, seen_from

ALL: tuple[Channel, ...] = get_args(Channel)
COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)
HASH = "0123456789abcdef" * 4


def read(data: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Header and planes, by OpenEXR."""
    file = OpenEXR.File(io.BytesIO(data), separate_channels=True)
    return file.header(), {name: channel.pixels for name, channel in file.channels().items()}


def write(stream: BinaryIO, of: Scene) -> None:
    rendered = frame(of)
    exr.write(stream, rendered.planes, rendered.window, of.camera, of.output, HASH)


def same_bits(a: NDArray[Any], b: NDArray[Any]) -> bool:
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_every_bit_of_every_channel_returns_through_openexr(compression: Compression) -> None:
    of = scene(channels=ALL, compression=compression)
    rendered = frame(of)
    header, planes = read(exr.encode(rendered, of, HASH))
    assert header["compression"] == exr.COMPRESSION[compression]
    assert header["type"] == OpenEXR.scanlineimage
    assert planes.keys() == rendered.planes.keys()
    assert all(same_bits(planes[name], plane) for name, plane in rendered.planes.items())


def test_the_random_planes_hold_the_difficult_values() -> None:
    plane = frame(scene()).planes["Z"]
    tiny = np.finfo(np.float32).tiny
    assert np.isinf(plane).any()
    assert (np.abs(plane[plane != 0]) < tiny).any()


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_openimageio_reads_what_openexr_reads(compression: Compression, tmp_path: Path) -> None:
    of = scene(channels=ALL, compression=compression, half_normals=True)
    rendered = frame(of, window=(3, 2, 38, 30))
    path = tmp_path / "image.exr"
    path.write_bytes(exr.encode(rendered, of, HASH))
    image = OpenImageIO.ImageInput.open(str(path))
    assert image is not None, OpenImageIO.geterror()
    spec = image.spec()
    assert (spec.x, spec.y, spec.width, spec.height) == (3, 2, 35, 28)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, 40, 30)
    assert spec.get_string_attribute("conicoid/sceneHash") == HASH
    stored = exr._channels(rendered.planes, of.output)
    assert set(spec.channelnames) == set(stored)
    for index, (name, kind) in enumerate(zip(spec.channelnames, spec.channelformats, strict=True)):
        assert str(kind) == {"float32": "float", "float16": "half", "uint32": "uint"}[stored[name].dtype.name]
        pixels = image.read_image(0, 0, index, index + 1, str(kind))
        assert pixels is not None, image.geterror()
        pixels = pixels.reshape(stored[name].shape)
        if kind == "half":
            pixels = pixels.view(np.float16)
        assert same_bits(pixels, stored[name]), name
    image.close()


def test_half_normals_are_the_float_normals_rounded_once() -> None:
    of = scene(channels=("N", "Z"), half_normals=True)
    rendered = frame(of)
    _, planes = read(exr.encode(rendered, of, HASH))
    assert same_bits(planes["N.X"], rendered.planes["N.X"].astype(np.float16))
    assert planes["Z"].dtype == np.float32


@pytest.mark.parametrize("window", [(0, 0, 40, 30), (0, 0, 1, 1), (39, 29, 40, 30), (5, 7, 6, 30)])
def test_windows_are_stored_inclusive_and_pixels_land_where_they_were(window: tuple[int, int, int, int]) -> None:
    of = scene()
    rendered = frame(of, window)
    header, planes = read(exr.encode(rendered, of, HASH))
    x0, y0, x1, y1 = window
    assert np.array_equal(header["displayWindow"], [(0, 0), (39, 29)])
    assert np.array_equal(header["dataWindow"], [(x0, y0), (x1 - 1, y1 - 1)])
    assert same_bits(planes["Z"], rendered.planes["Z"])


def test_header_says_what_made_the_image_and_when_is_not_part_of_it() -> None:
    camera = seen_from(near=0.1, far=1e10, cx=1 / 3)
    of = scene(camera, precision="float64", normal_space="camera", normal_side="outward")
    header, _ = read(exr.encode(frame(of), of, HASH))
    ours = {name: value for name, value in header.items() if name.startswith("conicoid/")}
    described = json.loads(ours.pop("conicoid/camera"))
    assert ours == {
        "conicoid/version": __version__,
        "conicoid/sceneHash": HASH,
        "conicoid/precision": "float64",
        "conicoid/depth": exr.DEPTH_MEANING,
        "conicoid/backgroundDepth": float("inf"),
        "conicoid/normalSpace": "camera",
        "conicoid/normalSide": "outward",
    }
    assert header["software"] == f"conicoid {__version__}"
    assert "capDate" not in header
    assert (described["cx"], described["far"], described["crop"]) == (1 / 3, 1e10, [0, 0, 40, 30])
    assert described["world_from_camera"] == np.eye(4).tolist()


def test_a_camera_without_far_plane_is_described_without_one() -> None:
    of = scene()
    header, _ = read(exr.encode(frame(of), of, HASH))
    assert "far" not in json.loads(header["conicoid/camera"])


def test_planes_are_left_as_they_were() -> None:
    of = scene(channels=ALL)
    rendered = frame(of)
    exr.encode(rendered, of, HASH)
    assert all(type(plane) is np.ndarray for plane in rendered.planes.values())
    assert all(same_bits(plane, frame(of).planes[name]) for name, plane in rendered.planes.items())


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_bytes_do_not_depend_on_the_number_of_threads(compression: Compression) -> None:
    """In processes of their own: OpenEXR's thread pool is one per process."""
    program = f"""
import hashlib, sys
from conicoid_service import exr
from tests.checkout import ROOT
from tests.service.scenes import frame, scene, seen_from
exr.set_threads(int(sys.argv[1]))
of = scene(seen_from(width=300, height=200, crop=(0, 0, 300, 200)), compression={compression!r})
print(hashlib.sha256(exr.encode(frame(of), of, "hash")).hexdigest())
"""
    digests = {
        subprocess.run([sys.executable, "-c", program, threads], capture_output=True, check=True, cwd=ROOT).stdout
        for threads in ("0", "1", "4")
    }
    assert len(digests) == 1


def test_a_stream_gets_the_same_bytes_as_memory(tmp_path: Path) -> None:
    of = scene()
    path = tmp_path / "image.exr"
    with path.open("w+b", buffering=0) as stream:
        write(stream, of)
    assert hashlib.sha256(path.read_bytes()).digest() == hashlib.sha256(exr.encode(frame(of), of, HASH)).digest()


def test_a_buffered_blob_gets_the_same_bytes_as_memory_and_has_them_when_the_buffer_is_gone() -> None:
    of = scene(seen_from(width=600, height=400, crop=(0, 0, 600, 400)), compression="none")  # more than a buffer holds
    with Blob() as blob, blob.shared() as other:
        with blob.buffered() as stream:
            write(stream, of)
        assert blob.read() == other.read() == exr.encode(frame(of), of, HASH)


def test_an_image_of_one_pixel_is_an_image() -> None:
    of: Scene = scene(seen_from(width=1, height=1, crop=(0, 0, 1, 1)))
    _, planes = read(exr.encode(Frame({"Z": np.full((1, 1), np.inf, np.float32)}, (0, 0, 1, 1), 0, 0), of, HASH))
    assert planes["Z"].shape == (1, 1)
