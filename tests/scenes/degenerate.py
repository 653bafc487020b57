"""Surfaces of lower rank, seen so that exact zeros occur: they render as what they are.

`CENTRED` puts the centre of pixel (12, 8) on the axis of view; coordinates are dyadic, so that rays through an
apex or along a ruling are exactly that.
"""

from tests.scenes.catalogue import PROJECTIONS, Document, add, document, either, orthographic, pinhole, scene

CENTRED = {"cx": 12.5, "cy": 8.5}
QUARTER_TURN_X = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, -4], [0, 0, 0, 1]]


def coefficients(*ten: float) -> Document:
    """A `quadric` at (0, 0, -4)."""
    return {"shape": "quadric", "coefficients": list(ten), "center": [0, 0, -4]}


SURFACES: dict[str, tuple[str, Document]] = {
    "double_plane": (
        "x² = 0 is hit by every ray that crosses it, with no gradient to shade by",
        coefficients(1, 0.5, 0.75, 0, 0.25, 0.375, 0, 0.5625, 0, 0),
    ),
    "line": ("x² + z² = 0: only the rays through the line hit", coefficients(1, 0, 0, 0, 0, 0, 0, 1, 0, 0)),
    "point": ("x² + y² + z² = 0: one ray hits", coefficients(1, 0, 0, 0, 1, 0, 0, 1, 0, 0)),
    "empty": ("x² + y² + z² + 1 = 0 has no points", coefficients(1, 0, 0, 0, 1, 0, 0, 1, 0, 1)),
    "imaginary_planes": ("x² + 1 = 0 has no points and rank 2", coefficients(1, 0, 0, 0, 0, 0, 0, 0, 0, 1)),
    "everywhere_outside": ("1 = 0 has no points at all", coefficients(0, 0, 0, 0, 0, 0, 0, 0, 0, 1)),
    "one_plane": ("a linear f: one root, no discriminant", coefficients(0, 0, 0, 0.5, 0, 0, 0.25, 0, 1, 0.125)),
    "plane_pair": ("xz = 0: two planes by one matrix", coefficients(0, 0, 0.5, 0, 0, 0.25, 0, 0, 0, 0)),
    "edge_on_plane": (
        "rays within the plane miss it, all others run beside it or away from it",
        {"shape": "plane", "transform": QUARTER_TURN_X},
    ),
    "cone_towards_eye": ("the middle ray meets the apex alone, from inside", {"shape": "cone", "center": [0, 0, -4]}),
    "cone_from_the_side": (
        "the middle ray touches the apex, where the silhouettes cross",
        {"shape": "cone", "radii": [1, 0.5], "transform": QUARTER_TURN_X},
    ),
    "half_cone_capped_at_its_apex": (
        "a cap that is one point, tied with the surface",
        {"shape": "cone", "transform": QUARTER_TURN_X, "z_range": [0, 1.25], "capped": True},
    ),
    "crossed_planes_on_the_axis": (
        "rays through the crossing line have no gradient there",
        {"shape": "crossed_planes", "radii": [1, 0.5], "transform": QUARTER_TURN_X},
    ),
    "parallel_planes_face_on": ("two constant depths", {"shape": "parallel_planes", "center": [0, 0, -4]}),
    "parallel_planes_edge_on": (
        "some rays run within a plane for ever",
        {"shape": "parallel_planes", "radius": 0.5, "transform": QUARTER_TURN_X},
    ),
    "disc": (
        "z0 = z1: the surface is a circle, both caps are one disc",
        {"shape": "sphere", "radius": 1.5, "transform": QUARTER_TURN_X, "z_range": [0.25, 0.25], "capped": True},
    ),
    "inside_everywhere": (
        "f = -1 has no surface, but its caps are whole planes",
        {**coefficients(0, 0, 0, 0, 0, 0, 0, 0, 0, -1), "z_range": [-1, 1], "capped": True},
    ),
    "z_range_is_one_point": (
        "a closed range that only touches the sphere's pole",
        {"shape": "sphere", "center": [0, 0, -4], "z_range": [1, 1]},
    ),
}

for name, (reason, quadric) in SURFACES.items():
    for projection in PROJECTIONS:
        add(f"{name}_{projection}", reason, document([quadric], either(projection, **CENTRED)))


@scene
def cylinder_end_on() -> Document:
    """A = B = 0 on every ray: the surface is missed, the caps are hit, walls included."""
    return document(
        [{"shape": "cylinder", "center": [0.125, 0.125, -4], "radius": 1, "z_range": [-1, 1], "capped": True}],
        orthographic(),
    )


@scene
def open_cylinder_end_on() -> Document:
    """Without caps nothing is left of a cylinder seen along its axis."""
    return document([{"shape": "cylinder", "center": [0.125, 0.125, -4]}], orthographic())


@scene
def hyperboloid_end_on() -> Document:
    """Caps are hit where S < 0: the waist is wider than the rays are apart."""
    return document(
        [{"shape": "hyperboloid_one_sheet", "center": [0, 0, -4], "z_range": [-1, 0.5], "capped": True}],
        orthographic(),
    )


@scene
def paraboloid_along_its_axis() -> Document:
    """A = 0 on every ray, identically: one root each."""
    return document([{"shape": "paraboloid", "center": [0, 0, -4]}], orthographic())


@scene
def saddle_along_its_axis() -> Document:
    """A = 0 on every ray of a hyperbolic paraboloid, with capped extent."""
    quadric = {"shape": "hyperbolic_paraboloid", "center": [0, 0, -4], "z_range": [-0.5, 0.5], "capped": True}
    return document([quadric], orthographic())


@scene
def paraboloid_seen_down_its_axis() -> Document:
    """A vanishes on the middle ray alone: its second root goes to infinity."""
    return document([{"shape": "paraboloid", "radius": 0.5, "center": [0, 0, -4]}], pinhole(**CENTRED))


@scene
def rays_along_rulings() -> Document:
    """A hyperboloid seen along its rulings: two rays lie in the surface and miss, the others have one root."""
    transform = [[1, 0, 0, 0], [0, 1, -1, 0], [0, 0, -1, 0], [0, 0, 0, 1]]
    camera = orthographic(fx=8, fy=8, **CENTRED)
    del camera["view_height"]
    return document([{"shape": "hyperboloid_one_sheet", "transform": transform}], camera)


@scene
def ruling_through_the_eye() -> Document:
    """The eye on a saddle: one root is the eye itself, and the middle ray lies in the surface."""
    transform = [[1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    upright = [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
    quadric = {"shape": "hyperbolic_paraboloid", "transform": transform}
    return document([quadric], pinhole(world_from_camera=upright, **CENTRED))
