"""What the kernels compute is within the bounds they state, and the bounds are not so loose that nothing would tell."""

import pytest

from tests.cl.bounds_probe import GENERAL, SIMPLE, BoundsProbe
from tests.scenes import as_scene
from tests.scenes.catalogue import PROJECTIONS, document
from tests.scenes.stress_mix import Mix
from tests.stress.workload import balls, far_and_tiny


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> BoundsProbe:
    probe = BoundsProbe(tmp_path_factory.mktemp("probe"))
    sample(probe, range(6), per_quadric=16)
    return probe


def sample(probe: BoundsProbe, seeds: range, per_quadric: int) -> None:
    """Mixes of all shapes, small balls, far and tiny things."""
    for seed in seeds:
        quadrics, camera, sides = Mix(seed).scene(12, PROJECTIONS[seed % 2], 640, 480)
        probe.check(as_scene(document(quadrics, camera, **sides)), per_quadric, seed, general=True)
        crowd = as_scene(balls(seed, 40, 640, 480))
        for general in (False, True):
            probe.check(crowd, per_quadric, seed, general=general)
        tiny = as_scene(far_and_tiny(seed))
        probe.check(tiny, 8 * per_quadric, seed, general=True)
        probe.check(tiny, 8 * per_quadric, seed, general=False)


def test_no_error_is_beyond_its_bound(probe: BoundsProbe) -> None:
    assert probe.evaluations > 10_000
    assert probe.beyond == 0, dict(probe.worst)


@pytest.mark.parametrize("name", [*GENERAL, *SIMPLE])
def test_every_bound_is_compared_with_errors(name: str, probe: BoundsProbe) -> None:
    assert 2.0**-12 < probe.worst[name] <= 1
