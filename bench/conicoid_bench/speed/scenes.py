"""The scenes of `conicoid bench speed`, all 1920 x 1080, and why each is there."""

from collections.abc import Iterator

from conicoid_bench.pieces import balls_and_sticks, sticks
from conicoid_bench.scenes import BenchScene
from conicoid_bench.workloads import ellipsoids, out_of_view, sphere_over, spheres


def built_in(quick: bool = False) -> Iterator[BenchScene]:
    """The generated scenes, but for the largest where it must be quick."""
    yield BenchScene("nothing in view", "1,000 ellipsoids behind and beside the camera", out_of_view(1000))
    yield BenchScene("1 sphere", "over 60 % of the image", sphere_over(0.6))
    yield BenchScene("64 spheres", "a few large ones", spheres(64, 0.6))
    yield BenchScene("1,000 ellipsoids", "some behind each other", ellipsoids(1_000, 1.0))
    yield BenchScene("100,000 ellipsoids", "some 60 pixels each, three deep", ellipsoids(100_000, 3.0))
    yield BenchScene("20,000 sticks", "capped cylinders of some 300 pixels each, three deep", sticks(20_000, 3.0))
    yield BenchScene("5,000 bonds", "balls and sticks, as molecules are drawn", balls_and_sticks(5_000, 1.0))
    if not quick:
        yield BenchScene("1,000,000 ellipsoids", "some 6 pixels each, three deep", ellipsoids(1_000_000, 3.0))
