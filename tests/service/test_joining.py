"""Joined bands are the frame, byte for byte, or an error that says what is wrong with them."""

import tracemalloc
from collections.abc import AsyncIterator, Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.canonical import quadrics_hash, scene_hash
from conicoid.data_window import tight_window
from conicoid.engine import Frame
from conicoid.scene import Channel, Compression, DataWindow, Scene
from conicoid_service import exr, joining
from conicoid_service.bands import MOST_BANDS, Window, band_crop, band_view
from conicoid_service.blob import Blob
from conicoid_service.errors import BandsError, ReportedError
from conicoid_service.pipeline import Pipeline
from conicoid_service.settings import Settings
from conicoid_service.views import view_line
from tests.service.conftest import FAKE
from tests.service.scenes import PLANES, frame, scene, seen_from, sphere

ALL: tuple[Channel, ...] = get_args(Channel)
COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)
CROP: Window = (2, 1, 38, 28)
HITS = {"some": (9, 7, 20, 13), "all": CROP, "none": None}


def planes_of(of: Scene, hits: Window | None) -> Frame:
    """The crop as the engine gives it before anything is cut: arbitrary bits, hits in a box."""
    drawn = frame(replace(of, output=replace(of.output, channels=ALL)))
    x0, y0 = of.camera.crop[:2]
    mask = drawn.planes["A"] = np.zeros_like(drawn.planes["A"])
    if hits:
        mask[hits[1] - y0 : hits[3] - y0, hits[0] - x0 : hits[2] - x0] = 1
    return drawn


def part_of(drawn: Frame, window: Window, of: Scene) -> Frame:
    """A window of it, with the channels that are asked for."""
    x0, y0, x1, y1 = window
    left, top = drawn.window[:2]
    names = [name for channel in of.output.channels for name in PLANES[channel]]
    part = slice(y0 - top, y1 - top), slice(x0 - left, x1 - left)
    return Frame({name: np.ascontiguousarray(drawn.planes[name][part]) for name in names}, window, 0, 0)


def in_one_piece(of: Scene, drawn: Frame) -> bytes:
    mask, window = drawn.planes["A"], of.camera.crop
    if of.output.data_window == "tight":
        window = tight_window(window, np.any(mask, axis=1), np.any(mask, axis=0))
    return exr.encode(part_of(drawn, window, of), of, scene_hash(of))


def in_bands(of: Scene, drawn: Frame, count: int) -> list[bytes]:
    bands = []
    for band in range(count):
        part = Scene(of.quadrics, *band_view(of.camera, of.output, band_crop(of.camera.crop, band, count)))
        bands.append(exr.encode(part_of(drawn, part.camera.crop, part), part, scene_hash(part)))
    return bands


def joined(of: Scene, bands: Sequence[bytes]) -> bytes:
    stream = BytesIO()
    joining.join(stream, of.camera, of.output, [BytesIO(band) for band in bands], quadrics_hash(of.quadrics))
    return stream.getvalue()


def seen(**output: Any) -> Scene:
    return scene(seen_from(crop=CROP), **output)


@pytest.mark.parametrize("hits", HITS)
@pytest.mark.parametrize("half_normals", [False, True])
@pytest.mark.parametrize("channels", [ALL, ("N", "id"), ("Z",)])
def test_bands_join_to_the_bytes_of_one_piece(channels: tuple[Channel, ...], half_normals: bool, hits: str) -> None:
    for compression in COMPRESSIONS:
        for data_window in get_args(DataWindow):
            of = seen(
                channels=channels, half_normals=half_normals, compression=compression, data_window=data_window,
                background_depth=2.5,
            )  # fmt: skip
            drawn = planes_of(of, HITS[hits])
            whole = in_one_piece(of, drawn)
            for count in (1, 2, 5, CROP[3] - CROP[1]):
                assert joined(of, in_bands(of, drawn, count)) == whole


def test_bands_of_any_heights_join() -> None:
    of = seen(channels=ALL)
    drawn = planes_of(of, None)
    bands = in_bands(of, drawn, 3)
    last = in_bands(of, drawn, 9)[6:]
    assert joined(of, [*bands[:2], *last]) == in_one_piece(of, drawn)


def rendered_with(**changes: Any) -> list[bytes]:
    """Planes that zip makes smaller, as an image's are: only such rows have checksums."""
    of = replace(seen(), **changes)
    drawn = planes_of(of, None)
    steps = {name: (np.arange(plane.size) // 7).astype(plane.dtype) for name, plane in drawn.planes.items()}
    smooth = {name: steps[name].reshape(plane.shape) for name, plane in drawn.planes.items()}
    return in_bands(of, replace(drawn, planes=smooth), 3)


MINE = rendered_with()
OTHERS = {
    "camera": rendered_with(camera=seen_from(crop=CROP, near=1.0)),
    "output": rendered_with(output=replace(seen().output, background_depth=7)),
    "quadrics": rendered_with(quadrics=replace(sphere(), radii=np.full((1, 3), 2.0))),
    "crop": rendered_with(camera=seen_from(crop=(2, 1, 39, 28))),
}
WRONG = {
    "missing": (MINE[1:], "band 1 of 2 begins at row 10 and not at 1; give all bands"),
    "a gap": ([MINE[0], MINE[2]], "band 2 of 2 begins at row 19 and not at 10; give all bands"),
    "the last missing": (MINE[:2], "the bands end at row 19 and the frame at 28; give all of them"),
    "out of order": ([MINE[1], MINE[0], MINE[2]], "band 1 of 3 begins at row 10 and not at 1"),
    "twice": ([MINE[0], *MINE], "band 2 of 4 begins at row 1 and not at 10"),
    "none": ([], "the bands end at row 1 and the frame at 28"),
    "empty": ([MINE[0], b"", MINE[2]], "band 2 of 3 is damaged, or no band at all"),
    "no image": ([b"\x89PNG", *MINE], "band 1 of 4 is damaged, or no band at all"),
    **{f"of another {what}": ([*MINE[:2], bands[2]], "band 3 of 3 is of another") for what, bands in OTHERS.items()},
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_with_bands_is_said(what: str) -> None:
    bands, message = WRONG[what]
    with pytest.raises(BandsError, match=message):
        joined(seen(), bands)


def test_bands_of_another_version_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exr, "__version__", "0.0.9")
    old = rendered_with()
    with pytest.raises(BandsError, match=r"band 1 of 3 was rendered by Conicoid 0\.0\.9"):
        joined(seen(), old)


@given(st.integers(0, 2), st.integers(0, 8 * len(MINE[0]) - 1))
def test_a_bit_that_flips_makes_an_error_or_no_difference(band: int, bit: int) -> None:
    bands = [bytearray(one) for one in MINE]
    bands[band][bit // 8 % len(bands[band])] ^= 1 << bit % 8
    try:
        made = joined(seen(), [bytes(one) for one in bands])
    except BandsError as error:
        said = str(error)
    else:
        said = f"band {band + 1} of 3 " if made == joined(seen(), MINE) else "another image"
    assert f"band {band + 1} of 3 " in said


@given(st.integers(0, len(MINE[0]) - 1))
def test_a_band_that_ends_too_early_is_damaged(length: int) -> None:
    with pytest.raises(BandsError, match=r"band 1 of 3 is damaged"):
        joined(seen(), [MINE[0][:length], *MINE[1:]])


def test_a_plane_of_another_type_is_damage() -> None:
    of = seen(channels=("Z", "id"))
    drawn = planes_of(of, None)
    bands = in_bands(of, drawn, 3)
    part = Scene(of.quadrics, *band_view(of.camera, of.output, band_crop(CROP, 1, 3)))
    planes = part_of(drawn, part.camera.crop, part).planes
    bands[1] = exr.encode(
        Frame(planes | {"id": planes["id"].view(np.float32)}, part.camera.crop, 0, 0), part, scene_hash(part)
    )
    with pytest.raises(BandsError, match="band 2 of 3 is damaged"):
        joined(of, bands)


@pytest.mark.parametrize("data_window", ["full", "tight"])
def test_joining_holds_the_frame_once_and_one_band(data_window: DataWindow, tmp_path: Path) -> None:
    size, count = 1024, 8
    of = scene(seen_from(width=size, height=size, crop=(0, 0, size, size)), channels=ALL, data_window=data_window)
    bands = [BytesIO(band) for band in in_bands(of, planes_of(of, (1, 1, size - 1, size - 1)), count)]
    frame_bytes = 4 * size * size * sum(map(len, PLANES.values()))
    with (tmp_path / "joined.exr").open("w+b") as stream:
        tracemalloc.start()
        joining.join(stream, of.camera, of.output, bands, quadrics_hash(of.quadrics))
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert frame_bytes < peak < frame_bytes * 1.25  # a band is an eighth


@pytest.fixture
async def pipeline(anyio_backend: str, search_path: None) -> AsyncIterator[Pipeline]:  # noqa: ARG001
    running = Pipeline(Settings(), FAKE)
    running.start()
    yield running
    await running.stop()


def view_of(of: Scene) -> Blob:
    return Blob.of(view_line(quadrics_hash(of.quadrics), of.camera, of.output))


@pytest.mark.anyio
async def test_a_process_joins_as_many_bands_as_there_may_be_and_passes_on_what_is_wrong(pipeline: Pipeline) -> None:
    of = scene(seen_from(width=8, height=MOST_BANDS, crop=(0, 0, 8, MOST_BANDS)))
    drawn = planes_of(of, None)
    bands, hashes = in_bands(of, drawn, MOST_BANDS), (scene_hash(of), quadrics_hash(of.quadrics))
    image, timings = await pipeline.join(view_of(of), [Blob.of(one) for one in bands], *hashes, escalated=(5, 1))
    with image.blob:
        assert image.blob.read() == in_one_piece(of, drawn)
    assert (image.scene_hash, image.refined, image.settled) == (hashes[0], 5, 1)
    assert timings.keys() == {"queue", "join"}
    with pytest.raises(ReportedError, match="band 1 of 127 begins at row 1 and not at 0") as refused:
        await pipeline.join(view_of(of), [Blob.of(one) for one in bands[1:]], *hashes)
    assert refused.value.code == "bands"
