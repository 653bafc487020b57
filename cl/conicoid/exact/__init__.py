"""The image decided in exact arithmetic on the host: every number is rational or one square root away from it.

    scene -> rays.py (camera) -> forms.py (one quadric along the rays) -> quadric.py (its integers)
          -> hits.py (where one ray meets it) -> scene.py (the nearest) -> pixel.py (its channels)

Binary64 inputs are rationals, so a pixel's quadratic a t^2 + 2b t + c has integer coefficients once denominators are
cleared, and its roots are surds (p + k sqrt(s))/q. Comparing two of them, or one with a number, takes squarings only
(surd.py); rounding one to binary32 takes an enclosure and, at a tie, such a comparison (rounding.py).
"""

from conicoid.exact.forms import ExactForms, RationalPolynomial
from conicoid.exact.pixel import ExactPixel
from conicoid.exact.planes import FlatPiece, FlatPieces, SeenPlane
from conicoid.exact.polynomial import Linear
from conicoid.exact.quadric import CAP_HIGH, CAP_LOW, SURFACE
from conicoid.exact.scene import ExactScene

__all__ = [
    "CAP_HIGH", "CAP_LOW", "SURFACE", "ExactForms", "ExactPixel", "ExactScene", "FlatPiece", "FlatPieces", "Linear",
    "RationalPolynomial", "SeenPlane",
]  # fmt: skip
