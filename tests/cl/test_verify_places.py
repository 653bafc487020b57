"""Which pixels are checked."""

import numpy as np
from numpy.typing import NDArray

from conicoid.verify import every_place, sampled_places, silhouettes

Planes = dict[str, NDArray[np.generic]]


def disc(size: int, radius: float) -> Planes:
    """A disc of id 7 at depth 2 in the middle of nothing."""
    y, x = np.mgrid[:size, :size] - (size - 1) / 2
    inside = np.hypot(x, y) < radius
    return {
        "id": np.where(inside, 7, 0).astype(np.uint32),
        "Z": np.where(inside, 2, np.inf).astype(np.float32),
    }


def test_every_place_is_every_pixel_row_by_row() -> None:
    assert every_place((2, 3)).tolist() == [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]


def test_a_small_image_is_checked_whole() -> None:
    assert sampled_places(disc(8, 3), 64).tolist() == every_place((8, 8)).tolist()


def test_half_of_a_sample_lies_on_silhouettes_and_no_pixel_is_checked_twice() -> None:
    planes = disc(200, 80)
    places = sampled_places(planes, 300)
    assert len(np.unique(places, axis=0)) == len(places) == 300
    assert silhouettes(planes)[tuple(places.T)].sum() >= 150


def test_where_silhouettes_are_short_the_rest_is_random() -> None:
    planes = disc(100, 0.8)
    places = sampled_places(planes, 200)
    assert len(places) == 200
    assert silhouettes(planes)[tuple(places.T)].sum() == silhouettes(planes).sum() > 0


def test_a_sample_is_the_same_every_time_and_another_with_another_seed() -> None:
    planes = disc(100, 40)
    assert np.array_equal(sampled_places(planes, 200), sampled_places(planes, 200))
    assert not np.array_equal(sampled_places(planes, 200), sampled_places(planes, 200, seed=1))


def test_silhouettes_are_both_sides_of_every_change_of_id_mask_or_depth() -> None:
    step: Planes = {"Z": np.array([[1, 1, 1, 1.5, 1.501]], dtype=np.float32)}
    assert silhouettes(step).tolist() == [[False, False, True, True, False]]
    for name in ("id", "A"):
        assert silhouettes({name: np.array([[0, 0, 1]]).T}).ravel().tolist() == [False, True, True]
    assert not silhouettes({"N.X": np.array([[0, 0, 1]])}).any()


def test_a_background_is_no_silhouette_in_itself() -> None:
    for depth in (np.inf, 0, -1):
        assert not silhouettes({"Z": np.full((3, 3), depth, dtype=np.float32)}).any()
