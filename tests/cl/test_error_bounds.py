"""What the kernels compute is within the bounds they state, and the bounds are not so loose that nothing would tell."""

import pytest

from tests.cl.bounds_probe import GENERAL, SIMPLE, BoundsProbe, sample


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> BoundsProbe:
    probe = BoundsProbe(tmp_path_factory.mktemp("probe"))
    sample(probe, range(6), per_quadric=16)
    return probe


def test_no_error_is_beyond_its_bound(probe: BoundsProbe) -> None:
    assert probe.evaluations > 10_000
    assert probe.beyond == 0, dict(probe.worst)


@pytest.mark.parametrize("name", [*GENERAL, *SIMPLE])
def test_every_bound_is_compared_with_errors(name: str, probe: BoundsProbe) -> None:
    assert 2.0**-12 < probe.worst[name] <= 1
