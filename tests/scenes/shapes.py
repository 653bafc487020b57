"""Every shape, in both projections, bare and bounded in every way."""

from tests.scenes.catalogue import PROJECTIONS, Document, add, document, either

# A rotation about no special axis and a principal point at no pixel's corner: nothing vanishes by chance.
POSE = {"center": [0.1, -0.2, -4], "rotation": [0.31, -0.53, 0.17, 0.79]}

OFF_CENTRE = {"cx": 12.3, "cy": 7.9}

SHAPES: dict[str, Document] = {
    "sphere": {"radius": 1.25},
    "ellipsoid": {"radii": [1.5, 0.75, 1.125]},
    "cylinder": {"radii": [0.75, 0.5]},
    "cone": {"radii": [0.75, 0.5]},
    "paraboloid": {"radii": [0.7, 1.1]},
    "hyperbolic_paraboloid": {"radii": [0.7, 0.9]},
    "hyperboloid_one_sheet": {"radii": [0.5, 0.4, 0.6]},
    "hyperboloid_two_sheets": {"radii": [0.8, 0.7, 0.4]},
    "parabolic_cylinder": {"radius": 0.6},
    "hyperbolic_cylinder": {"radii": [0.4, 0.5]},
    "plane": {},
    "parallel_planes": {"radius": 0.6},
    "crossed_planes": {"radii": [1, 0.6]},
    "quadric": {"coefficients": [1.5, 0.25, -0.5, 0.125, 0.75, 0.3, -0.2, -0.6, 0.1, -0.4]},
}

BOUNDS: dict[str, tuple[str, Document, Document]] = {
    "bare": ("the surface alone, second roots included", {}, {}),
    "z_range": ("both roots may be cut off by the range", {"z_range": [-0.5, 0.75]}, {}),
    "capped": ("caps close the range and hide what is behind", {"z_range": [-0.5, 0.75], "capped": True}, {}),
    "clipped": (
        "world half-spaces cut surface and caps",
        {"z_range": [-0.75, 1], "capped": True, "clip": [[1, 0.25, 0.5, 2.3], [-0.3, -1, 0.2, 1.2]]},
        {},
    ),
    "near_far": ("planar depth is cut at both ends", {}, {"near": 3.6, "far": 4.7}),
}

for shape, parameters in SHAPES.items():
    for projection in PROJECTIONS:
        for bound, (reason, extent, depth_range) in BOUNDS.items():
            quadric = {"shape": shape, **parameters, **POSE, **extent}
            camera = either(projection, **OFF_CENTRE, **depth_range)
            add(f"{shape}_{projection}_{bound}", f"{shape}, {projection}: {reason}", document([quadric], camera))
