"""Views as lines of JSON and back."""

import json

import numpy as np
from hypothesis import given

from conicoid.canonical import quadrics_hash, scene_hash
from conicoid.document import parse
from conicoid_service.views import view_from, view_line
from tests.cl.documents import documents


@given(documents)
def test_line_gives_the_same_view_back_and_the_scenes_hash(document: object) -> None:
    scene = parse(json.dumps(document).encode()).resolve()
    line = view_line(quadrics_hash(scene.quadrics), scene.camera, scene.output)
    assert line.count(b"\n") == 1
    assert json.loads(line)["scene_hash"] == scene_hash(scene)
    camera, output = view_from(line)
    assert output == scene.output
    np.testing.assert_array_equal(camera.world_from_camera, scene.camera.world_from_camera)
    for name in ("projection", "width", "height", "fx", "fy", "cx", "cy", "near", "far", "crop"):
        assert getattr(camera, name) == getattr(scene.camera, name)
