"""The camera as exact matrices: rays as linear functions of the doubled pixel coordinates p = (i', j', 1)."""

from dataclasses import dataclass
from functools import cached_property

from flint import fmpq, fmpq_mat, fmpz

from conicoid.scene import Camera
from tests.oracle.pixel_polynomial import Linear, integers
from tests.oracle.rounding import exact


@dataclass(frozen=True)
class Affine:
    """Three components, each linear in p, over one positive denominator."""

    rows: tuple[Linear, Linear, Linear]
    denominator: fmpz

    @classmethod
    def from_matrix(cls, matrix: fmpq_mat) -> "Affine":
        """From the upper three rows of a (3 or 4)×3 matrix that acts on p."""
        entries, denominator = integers(matrix.entries()[:9])
        return cls((Linear(*entries[0:3]), Linear(*entries[3:6]), Linear(*entries[6:9])), denominator)


class View:
    """A camera's rays, exactly.

    Attributes:
        camera: the camera itself.
        is_pinhole: whether all rays start at one point.
        world_from_camera: 4×4.
        origin, direction: 4×3, homogeneous camera coordinates of a ray's start (last row 0 0 1) and direction
            (last row 0) as functions of p.
    """

    def __init__(self, camera: Camera) -> None:
        self.camera = camera
        self.is_pinhole = camera.projection == "pinhole"
        self.world_from_camera = matrix(camera.world_from_camera.tolist())
        fx, fy, cx, cy = map(exact, (camera.fx, camera.fy, camera.cx, camera.cy))
        across = [[1 / (2 * fx), fmpq(0), -cx / fx], [fmpq(0), -1 / (2 * fy), cy / fy]]
        nothing, forward, one = [fmpq(0)] * 3, [fmpq(0), fmpq(0), fmpq(-1)], [fmpq(0), fmpq(0), fmpq(1)]
        if self.is_pinhole:
            self.origin = fmpq_mat([nothing, nothing, nothing, one])
            self.direction = fmpq_mat([*across, forward, nothing])
        else:
            self.origin = fmpq_mat([*across, nothing, one])
            self.direction = fmpq_mat([nothing, nothing, forward, nothing])

    @cached_property
    def world_origin(self) -> Affine:
        return Affine.from_matrix(self.world_from_camera * self.origin)

    @cached_property
    def world_direction(self) -> Affine:
        return Affine.from_matrix(self.world_from_camera * self.direction)

    @cached_property
    def camera_direction(self) -> Affine:
        return Affine.from_matrix(self.direction)


def matrix(rows: list[list[float]]) -> fmpq_mat:
    """Binary64 rows as an exact matrix."""
    return fmpq_mat([[exact(value) for value in row] for row in rows])
