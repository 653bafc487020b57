"""All stress scenes: importing this fills `STRESS`."""

from tests.scenes import (
    stress_extent,
    stress_flat,
    stress_forms,
    stress_mix,
    stress_order,
    stress_placement,
    stress_scale,
    stress_tangent,
)
from tests.scenes.stress import STRESS

__all__ = [
    "STRESS",
    "stress_extent",
    "stress_flat",
    "stress_forms",
    "stress_mix",
    "stress_order",
    "stress_placement",
    "stress_scale",
    "stress_tangent",
]
