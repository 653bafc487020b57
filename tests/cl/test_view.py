"""A camera's constants, for cameras of any size."""

import contextlib
import json

import numpy as np
import pytest
from hypothesis import given

from conicoid.document import parse
from conicoid.errors import CameraRangeError
from conicoid.view import view_of
from tests.cl.documents import Json, cameras


def view(camera: Json) -> None:
    body = json.dumps({"conicoid": 1, "quadrics": [], "camera": camera}).encode()
    constants = view_of(*parse(body).view())
    assert np.isfinite(constants.rays).all()
    assert np.isfinite(constants.image_rows).all()


@given(cameras())
def test_constants_are_finite_or_the_camera_is_refused(camera: Json) -> None:
    with contextlib.suppress(CameraRangeError):
        view(camera)


def test_camera_whose_rays_pass_binary64_is_refused() -> None:
    with pytest.raises(CameraRangeError, match="beyond"):
        view({"width": 4, "height": 3, "fx": 5e-324, "fy": 1})
