"""Checking rendered planes against exact arithmetic, on the user's own machine; no device, no kernels.

    planes -> places.py (which pixels) -> boxes.py (which quadrics each may see) -> check.py (is it right?)

What a verdict rests on: `conicoid.exact`, which decides pixels in integers; `boxes`, which leaves a quadric out only
where its bounding box cannot reach; and the resolved scene, which is the definition of the image. Casting, its error
bounds, its tiles and its culling are what is judged, and nothing here uses them.
"""

from conicoid.verify.boxes import PixelBoxes
from conicoid.verify.check import NORMAL_LIMIT, POSITION_LIMIT, Difference, Verdict, check
from conicoid.verify.places import every_place, sampled_places, silhouettes

__all__ = [
    "NORMAL_LIMIT",
    "POSITION_LIMIT",
    "Difference",
    "PixelBoxes",
    "Verdict",
    "check",
    "every_place",
    "sampled_places",
    "silhouettes",
]
