"""One device and one exact reference for all tests of the engine."""

from collections.abc import Callable
from functools import cache

import pytest

from conicoid.engine import Renderer
from tests import oracle
from tests.scenes import CATALOGUE, as_scene


@pytest.fixture(scope="session")
def renderer() -> Renderer:
    return Renderer()


@pytest.fixture(scope="session")
def exact_image() -> Callable[[str], oracle.Truth]:
    """The exact image of a scene of the catalogue; it does not depend on the precision asked."""
    return cache(lambda name: oracle.image(as_scene(CATALOGUE[name].document)))
