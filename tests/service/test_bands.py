"""A frame is cut into rows that are all there, once each, and no more than one unit of work may have."""

from dataclasses import replace
from io import BytesIO

import pytest
from hypothesis import given
from hypothesis import strategies as st

from conicoid.canonical import quadrics_hash, scene_hash, view_hash
from conicoid.engine import Renderer
from conicoid.scene import Output, Scene
from conicoid_service import exr, joining
from conicoid_service.bands import MOST_BANDS, Window, band_count, band_crop, band_view
from conicoid_service.channel import MAX_BLOBS
from tests.scenes import CATALOGUE, as_scene
from tests.service.scenes import CAMERA

crops = st.tuples(st.integers(0, 999), st.integers(0, 999), st.integers(1, 9999), st.integers(1, 9999)).map(
    lambda box: (box[0], box[1], box[0] + box[2], box[1] + box[3])
)


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


@given(crops, st.data())
def test_bands_are_all_rows_once_from_the_top(crop: Window, data: st.DataObject) -> None:
    count = data.draw(st.integers(1, crop[3] - crop[1]))
    bands = [band_crop(crop, band, count) for band in range(count)]
    assert [band[1] for band in bands] == [crop[1], *(band[3] for band in bands[:-1])]
    assert bands[-1][3] == crop[3]
    assert all((x0, x1) == (crop[0], crop[2]) and y0 < y1 for x0, y0, x1, y1 in bands)


@given(crops, st.integers(1, 10**8))
def test_no_band_has_more_pixels_than_it_may_unless_one_row_has_or_they_are_too_many(crop: Window, most: int) -> None:
    count = band_count(crop, "exact", most)
    width = crop[2] - crop[0]
    largest = max(y1 - y0 for _, y0, _, y1 in (band_crop(crop, band, count) for band in range(count)))
    assert 1 <= count <= min(crop[3] - crop[1], MOST_BANDS)
    assert width * largest <= most or largest == 1 or count == MOST_BANDS
    fewest = -(-width * (crop[3] - crop[1]) // most)
    assert count >= min(fewest, MOST_BANDS, crop[3] - crop[1])


def test_a_small_frame_and_one_that_is_not_exact_stay_whole() -> None:
    crop = (0, 0, 4096, 4096)
    assert band_count(crop, "exact", 4096 * 4096) == 1
    assert band_count(crop, "exact", 4096 * 4096 - 1) == 2
    assert band_count(crop, "float64", 1) == band_count(crop, "float32", 1) == 1


def test_all_bands_and_the_view_fit_into_one_message() -> None:
    assert MOST_BANDS + 1 <= MAX_BLOBS


def test_a_band_has_every_plane_in_full_and_the_mask_where_the_frame_is_cut_to_it() -> None:
    output = Output(("Z", "N"), compression="piz", data_window="tight", half_normals=True, background_depth=3)
    camera, of = band_view(CAMERA, output, (0, 10, 40, 20))
    assert camera == replace(CAMERA, crop=(0, 10, 40, 20))
    assert of == Output(("Z", "N", "A"), compression="zip", background_depth=3)
    assert band_view(CAMERA, replace(output, channels=("A", "Z")), CAMERA.crop)[1].channels == ("A", "Z")
    assert band_view(CAMERA, replace(output, data_window="full"), CAMERA.crop)[1].channels == ("Z", "N")


@pytest.mark.parametrize("name", CATALOGUE)
def test_rendered_bands_join_to_the_bytes_of_one_piece(name: str, renderer: Renderer) -> None:
    scene = as_scene(CATALOGUE[name].document)
    hashed, rows = quadrics_hash(scene.quadrics), scene.camera.crop[3] - scene.camera.crop[1]
    whole = exr.encode(renderer.render(scene), scene, scene_hash(scene))
    for count in {min(3, rows), rows}:
        bands = []
        for band in range(count):
            part = Scene(
                scene.quadrics, *band_view(scene.camera, scene.output, band_crop(scene.camera.crop, band, count))
            )
            hash_of_part = view_hash(hashed, part.camera, part.output)
            bands.append(BytesIO(exr.encode(renderer.render(part), part, hash_of_part)))
        joined = BytesIO()
        joining.join(joined, scene.camera, scene.output, bands, hashed)
        assert joined.getvalue() == whole
