"""Where quadrics are, how large and how sheared: the image must not notice."""

from collections.abc import Sequence

from tests.scenes.catalogue import Document, document, only_exact, orthographic, pinhole, scene

FAR_AWAY = 1e7


def away(x: float, y: float, z: float) -> list[float]:
    """A point that far from the origin on every axis."""
    return [FAR_AWAY + x, -FAR_AWAY + y, FAR_AWAY + z]


def posed_away() -> list[list[float]]:
    """The pose of a camera there, in default axes."""
    x, y, z = away(0, 0, 0)
    return [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]


def placed(shape: str, rows: Sequence[Sequence[float]], **keys: object) -> Document:
    """A shape under the upper three rows of a transform."""
    return {"shape": shape, "transform": [*rows, [0, 0, 0, 1]], **keys}


SHEAR = [[1.5, 0.5, 0.25, 0], [0.125, 0.75, -0.5, 0.25], [0.25, 0, 1, -4]]
MIRROR = [[-1, 0.25, 0, 0.5], [0.25, 1, 0.5, 0], [0, -0.5, 1, -4]]


@scene
def sheared_ellipsoid() -> Document:
    """Normals go by the inverse transpose."""
    return document([placed("ellipsoid", SHEAR, radii=[1, 0.5, 0.75])], pinhole())


@scene
def sheared_capped_cylinder() -> Document:
    """A cap's normal is not the image of the axis."""
    return document([placed("cylinder", SHEAR, z_range=[-0.5, 0.75], capped=True)], pinhole(), normal_side="outward")


@scene
def mirrored_capped_cone() -> Document:
    """A negative determinant does not turn normals inside out."""
    quadric = placed("cone", MIRROR, radii=[0.5, 0.75], z_range=[-1, 0.5], capped=True)
    return document([quadric], pinhole(), normal_side="outward")


@scene
def mirrored_sphere_facing() -> Document:
    """The facing side of a mirrored ball, orthographic."""
    return document([placed("sphere", MIRROR, radius=1.25)], orthographic(), normal_space="camera")


@scene
def uneven_scales() -> Document:
    """Columns of a transform from 1e-3 to 1e3, undone by the radii."""
    rows: list[list[float]] = [[1e3, 0, 0, 0.5], [0, 1e-3, 0, 0], [0, 0, 1, -4]]
    return document([placed("ellipsoid", rows, radii=[1e-3, 1e3, 0.5])], pinhole())


@scene
def needle() -> Document:
    """1 : 500, along no axis: a broken line of pixels."""
    quadric = {"shape": "ellipsoid", "radii": [4e-3, 4e-3, 2], "center": [0, 0, -4], "rotation": [0.3, 0.6, 0.1, 1]}
    return document([quadric], pinhole(width=64, height=48, fx=60, fy=60))


@only_exact
def needle_through_pixel_centres() -> Document:
    """A needle that rays of one column do hit."""
    quadric = {"shape": "ellipsoid", "radii": [1e-5, 1.5, 1e-5], "center": [0, 0, -4]}
    return document([quadric], pinhole(cx=12.5, cy=8.5))


@scene
def pancake() -> Document:
    """1 : 1e-6, almost edge on: both roots nearly coincide."""
    quadric = {"shape": "ellipsoid", "radii": [1.5, 1.5, 1.5e-6], "center": [0, 0, -4], "rotation": [0.6, 0.1, 0, 1]}
    return document([quadric], pinhole())


@scene
def pancake_face_on() -> Document:
    """Two faces a millionth apart."""
    return document([{"shape": "ellipsoid", "radii": [1.5, 1.5, 1e-6], "center": [0, 0, -4]}], orthographic())


@scene
def far_away() -> Document:
    """Camera and scene together at 1e7: nothing changes but P."""
    quadrics: list[Document] = [
        {"shape": "sphere", "center": away(-1, 0.25, -4)},
        {"shape": "cylinder", "center": away(1, 0, -4), "radius": 0.5, "rotation": [0.5, 0, 0.25, 1],
         "z_range": [-1, 1], "capped": True},
        {"shape": "cone", "center": away(0.5, -0.5, -5), "rotation": [1, 0, 0, 1], "z_range": [-1, 0]},
    ]  # fmt: skip
    return document(quadrics, pinhole(world_from_camera=posed_away()))


@scene
def far_away_orthographic() -> Document:
    """The same with parallel rays, and a clip plane through the far place."""
    x, _, _ = away(0, 0, 0)
    quadrics: list[Document] = [
        {"shape": "ellipsoid", "radii": [1.5, 1, 0.5], "center": away(0, 0, -4), "clip": [[1, 0, 0, 0.25 - x]]},
        {"shape": "parabolic_cylinder", "radius": 0.5, "center": away(0, -1, -5), "rotation": [-1, 0, 0, 1]},
    ]
    return document(quadrics, orthographic(world_from_camera=posed_away()))


@scene
def small_sphere_at_1e7() -> Document:
    """r = 0.1 at 1e7, seen from the origin: |C|² - r² has no digit of r left in binary64."""
    camera = pinhole(fx=6e8, fy=6e8)
    return document([{"shape": "sphere", "radius": 0.1, "center": [0.0125, 0.025, -FAR_AWAY]}], camera)


@scene
def small_capped_cylinder_at_1e7() -> Document:
    """Walls, ranges and caps of a thing of 0.1, seen from 1e7 away."""
    quadric = {"shape": "cylinder", "radius": 0.08, "center": [0.03, 0, -FAR_AWAY], "rotation": [0.5, 0.2, 0, 1],
               "z_range": [-0.1, 0.1], "capped": True}  # fmt: skip
    return document([quadric], pinhole(fx=6e8, fy=6e8))


@scene
def small_sphere_far_off_axis() -> Document:
    """r = 0.1 at 1e7 on every axis, looked at from the origin."""
    camera = {"width": 24, "height": 16, "fov_y": 1e-6,
              "look_at": {"eye": [0, 0, 0], "target": away(0, 0, 0), "up": [0, 1, 0]}}  # fmt: skip
    return document([{"shape": "sphere", "radius": 0.1, "center": away(0.01, 0.02, 0)}], camera)


@scene
def huge_units() -> Document:
    """Everything times 1e15: squares pass 1e30, and float32 still holds the depths."""
    quadrics = [{"shape": "sphere", "center": [-1e15, 0, -4e15], "radius": 1e15},
                {"shape": "cylinder", "center": [1e15, 0, -4e15], "radius": 5e14, "rotation": [1, 0, 0, 1],
                 "z_range": [-1e15, 1e15], "capped": True}]  # fmt: skip
    return document(quadrics, pinhole())


@scene
def tiny_units() -> Document:
    """Everything times 1e-15."""
    quadrics = [{"shape": "sphere", "center": [-1e-15, 0, -4e-15], "radius": 1e-15},
                {"shape": "cylinder", "center": [1e-15, 0, -4e-15], "radius": 5e-16, "rotation": [1, 0, 0, 1],
                 "z_range": [-1e-15, 1e-15], "capped": True}]  # fmt: skip
    return document(quadrics, orthographic(view_height=4e-15))


@scene
def subnormal_depths() -> Document:
    """Depths of 4e-41 have 15 bits in float32: none may be flushed to zero."""
    return document([{"shape": "sphere", "center": [0, 0, -4e-41], "radius": 1.25e-41}], pinhole())


@scene
def depth_beyond_float32() -> Document:
    """Depths of 4e39 are written as inf; A and id still say hit."""
    return document([{"shape": "sphere", "center": [0, 0, -4e39], "radius": 1e39}], pinhole())


@scene
def huge_coefficients() -> Document:
    """A surface does not change with the scale of its matrix: times 1e200."""
    quadric = {"shape": "quadric", "coefficients": [1e200, 0, 0, 0, 2e200, 0, 0, 1e200, 4e200, 15e200]}
    return document([quadric], pinhole())


@scene
def tiny_coefficients() -> Document:
    """The same, times 1e-200."""
    quadric = {"shape": "quadric", "coefficients": [1e-200, 0, 0, 0, 2e-200, 0, 0, 1e-200, 4e-200, 15e-200]}
    return document([quadric], pinhole())


@scene
def subpixel_spheres() -> Document:
    """Balls smaller than a pixel: hit only where a centre falls on one."""
    quadrics = [{"shape": "sphere", "center": [0.2 * k - 2.3, 0.13 * k - 1.5, -4], "radius": 0.06} for k in range(24)]
    return document(quadrics, pinhole())
