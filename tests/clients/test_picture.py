"""Pictures: clear where nothing was hit, near bright, normals as (n + 1) / 2, in place on the display window."""

import io
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from conicoid_client.exr import ExrError, decode
from conicoid_client.picture import ColourError, depth_colours, normal_colours, png
from tests.clients.exr_files import exr_bytes, half_hit

CLEAR, OPAQUE = 0, 255


def pixels(channels: dict[str, NDArray[Any]], width: int | None = None, **file: Any) -> NDArray[np.uint8]:
    picture = Image.open(io.BytesIO(png(decode(exr_bytes(channels, **file)), width=width)))
    return np.asarray(picture.convert("RGBA"))


def lightness(rgb: NDArray[np.uint8]) -> NDArray[np.float64]:
    return np.asarray(rgb @ np.array([0.2126, 0.7152, 0.0722]))


def test_depth_is_beside_normals_and_the_background_is_clear() -> None:
    seen = pixels(half_hit(4, 6))
    assert seen.shape == (4, 12, 4)
    np.testing.assert_array_equal(seen[..., 3], np.tile([OPAQUE] * 3 + [CLEAR] * 3, (4, 2)))


def test_normals_are_red_green_blue_of_half_n_plus_one() -> None:
    n = np.array([[[1, 0, 0], [0, -1, 0], [0, 0, 1], [-0.6, 0, 0.8]]], np.float32)
    expected = [[[255, 128, 128], [128, 0, 128], [128, 128, 255], [51, 128, 230]]]
    np.testing.assert_allclose(normal_colours(n), expected, atol=0.5 + 1e-3)  # half a step of rounding


def test_nearer_is_brighter() -> None:
    depth = np.linspace(1, 2, 50, dtype=np.float32)[None]
    light = lightness(depth_colours(depth, np.ones(depth.shape, bool))[0])
    assert (np.diff(light) <= 0).all()
    assert light[0] > light[-1] + 100


def test_a_few_far_outliers_do_not_darken_the_rest() -> None:
    depth = np.concatenate([np.linspace(1, 2, 999), [1e30]]).astype(np.float32)[None]
    hits = np.ones(depth.shape, bool)
    near, middle = lightness(depth_colours(depth, hits))[0, [0, 500]]
    assert near > middle + 30


def test_depths_over_many_decades_are_all_told_apart() -> None:
    depth = np.logspace(-3, 7, 11).astype(np.float32)[None]
    colours = depth_colours(depth, np.ones(depth.shape, bool))[0]
    assert len({tuple(colour) for colour in colours.tolist()}) == 11


def test_a_depth_beyond_float32_on_a_hit_is_shown_as_farthest() -> None:
    depth = np.array([[1, 2, np.inf, np.inf]], np.float32)
    seen = pixels({"Z": depth, "id": np.array([[1, 1, 1, 0]], np.uint32)})
    assert seen[0, :, 3].tolist() == [OPAQUE, OPAQUE, OPAQUE, CLEAR]
    assert seen[0, 2].tolist() == seen[0, 1].tolist()


def test_a_number_for_the_background_is_still_background() -> None:
    channels = half_hit()
    channels["Z"] = np.where(np.isinf(channels["Z"]), np.float32(1e10), channels["Z"])
    np.testing.assert_array_equal(pixels(channels), pixels(half_hit()))


def test_a_number_for_the_background_is_known_from_the_header_if_there_is_depth_alone() -> None:
    depth = half_hit()["Z"]
    numbered = np.where(np.isinf(depth), np.float32(0.1), depth)
    named = pixels({"Z": numbered}, attributes={"conicoid/backgroundDepth": 0.1})
    np.testing.assert_array_equal(named, pixels({"Z": depth}))


@pytest.mark.parametrize("name", ["Z", "T", "ZBack"])
def test_any_depth_alone_makes_one_panel(name: str) -> None:
    seen = pixels({name: half_hit(4, 6)["Z"]})
    assert seen.shape == (4, 6, 4)
    np.testing.assert_array_equal(seen, pixels(half_hit(4, 6))[:, :6])


def test_normals_alone_make_one_panel() -> None:
    channels = {name: plane for name, plane in half_hit(4, 6).items() if name != "Z"}
    np.testing.assert_array_equal(pixels(channels), pixels(half_hit(4, 6))[:, 6:])


def test_half_normals_look_like_float_normals() -> None:
    channels = {name: plane.astype(np.float16) if name != "Z" else plane for name, plane in half_hit().items()}
    np.testing.assert_array_equal(pixels(channels), pixels(half_hit()))


@pytest.mark.parametrize(
    "channels",
    [
        {"id": np.array([[0, 1, 2, 4_294_967_295]], np.uint32)},
        {"A": np.array([[0, 1, 1, 1]], np.float32)},
        {f"P.{axis}": np.array([[0, 1, -2, 3e38]], np.float32) for axis in "XYZ"},
    ],
    ids=["id", "A", "P"],
)
def test_files_without_depth_or_normals_are_shown_too(channels: dict[str, NDArray[Any]]) -> None:
    seen = pixels(channels)
    assert seen[0, :, 3].tolist() == [CLEAR, OPAQUE, OPAQUE, OPAQUE]


def test_neighbouring_ids_have_different_colours() -> None:
    seen = pixels({"id": np.array([[1, 2, 3, 4, 5, 6]], np.uint32)})[0, :, :3].astype(int)
    steps = np.abs(seen[:, None] - seen[None]).sum(axis=-1) + 1000 * np.eye(6, dtype=int)
    assert steps.min() > 40


def test_an_empty_image_is_a_clear_picture() -> None:
    seen = pixels({name: np.full((2, 3), np.inf if name == "Z" else 0, np.float32) for name in half_hit()})
    assert seen.shape == (2, 6, 4)
    assert not seen[..., 3].any()


def test_one_depth_everywhere_is_one_bright_colour() -> None:
    colours = depth_colours(np.full((2, 2), 7, np.float32), np.ones((2, 2), bool))
    assert len(np.unique(colours.reshape(-1, 3), axis=0)) == 1
    assert lightness(colours).min() > 200


def test_a_crop_is_shown_in_its_place() -> None:
    seen = pixels({"Z": np.ones((2, 3), np.float32)}, at=(4, 1), display=(10, 5))
    expected = np.zeros((5, 10), np.uint8)
    expected[1:3, 4:7] = OPAQUE
    np.testing.assert_array_equal(seen[..., 3], expected)


def test_a_shrunk_picture_keeps_its_shape_and_is_never_enlarged() -> None:
    assert pixels(half_hit(40, 60), width=30).shape == (10, 30, 4)
    assert pixels(half_hit(4, 6), width=9999).shape == (4, 12, 4)


def test_a_background_colour_fills_what_is_clear() -> None:
    image = decode(exr_bytes(half_hit(4, 6)))
    picture = Image.open(io.BytesIO(png(image, background="#102030")))
    assert picture.mode == "RGB"
    assert picture.getpixel((5, 0)) == (0x10, 0x20, 0x30)
    assert picture.getpixel((0, 0)) != (0x10, 0x20, 0x30)


def test_a_background_that_is_no_colour_is_refused() -> None:
    with pytest.raises(ColourError, match="mauvish"):
        png(decode(exr_bytes(half_hit())), background="mauvish")


def test_a_file_with_nothing_to_show_says_what_it_has() -> None:
    with pytest.raises(ExrError, match="only R"):
        png(decode(exr_bytes({"R": np.ones((2, 2), np.float32)})))


def test_the_same_image_gives_the_same_bytes() -> None:
    assert png(decode(exr_bytes(half_hit()))) == png(decode(exr_bytes(half_hit())))
