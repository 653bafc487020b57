"""Double-double rounds every value right, or says that it cannot: kernels that are certain of none leave it all."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from conicoid.engine import Renderer
from conicoid.scene import Channel
from tests.cl.kernel_sources import edit_kernels
from tests.oracle.answers import answers
from tests.oracle.promise import broken
from tests.scenes import CATALOGUE, as_scene
from tests.scenes.stress_catalogue import STRESS

# Last hits are not for this stage.
CHANNELS: tuple[Channel, ...] = ("Z", "T", "N", "P", "id", "A")
DOCUMENTS = {name: case.document for name, case in {**CATALOGUE, **STRESS}.items()}


@pytest.fixture(scope="module")
def doubtful(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Renderer]:
    with pytest.MonkeyPatch.context() as patch:
        doubt = "return __builtin_convertvector(~((low"
        edit_kernels(tmp_path_factory.mktemp("edited"), [("certify.h", doubt, f"return (mask)(-1); {doubt}")], patch)
        yield Renderer()


@pytest.mark.parametrize("name", DOCUMENTS)
def test_every_value_is_rounded_right(name: str, doubtful: Renderer) -> None:
    scene = as_scene(DOCUMENTS[name])
    output = replace(scene.output, channels=CHANNELS, precision="exact", data_window="full")
    scene = replace(scene, output=output)
    frame = doubtful.render(scene)
    assert not broken(frame.planes, answers(scene))


@pytest.mark.parametrize("name", ["crowd", "quadric_pinhole_z_range", "cylinder_pinhole_capped", "mix_1"])
def test_nearly_all_is_rounded_without_the_host(name: str, doubtful: Renderer) -> None:
    scene = as_scene(DOCUMENTS[name])
    frame = doubtful.render(replace(scene, output=replace(scene.output, channels=CHANNELS)))
    assert frame.refined > 10 * frame.settled
