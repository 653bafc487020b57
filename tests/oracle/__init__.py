"""The exact image of a scene, pixel by pixel: the reference that judges the engine.

It shares nothing with the engine but the scene's arrays: rays and surfaces are taken as they stand, every decision
is made on integers, and only the finished numbers are rounded, once.
"""

from tests.oracle.exact_image import Oracle, Truth, image, pixels

__all__ = ["Oracle", "Truth", "image", "pixels"]
