"""What is written: spaces, sides, backgrounds, windows, halves."""

from tests.scenes.catalogue import Document, document, only_exact, orthographic, pinhole, scene

QUADRICS: list[Document] = [
    {"shape": "hyperboloid_one_sheet", "radii": [0.5, 0.25, 0.5], "center": [-1, 0, -4], "rotation": [1, 0.25, 0, 1],
     "z_range": [-1, 1], "capped": True},
    {"shape": "paraboloid", "radius": 0.75, "center": [1, -1, -4], "rotation": [-1, 0, 0, 1], "z_range": [0, 1.5],
     "clip": [[0, 0, 1, 4.25]]},
]  # fmt: skip
POSE = {"look_at": {"eye": [1, 2, 1], "target": [0, 0, -4], "up": [0, 1, 0]}}


@scene
def world_normals_outward() -> Document:
    """Along +∇f, in the world."""
    return document(QUADRICS, pinhole(**POSE), normal_side="outward")


@scene
def camera_normals_facing() -> Document:
    """Towards the eye, in camera axes: z >= 0 on the axis of view."""
    return document(QUADRICS, pinhole(**POSE), normal_space="camera")


@scene
def camera_normals_outward_orthographic() -> Document:
    """Along +∇f, in camera axes, parallel rays."""
    return document(QUADRICS, orthographic(**POSE), normal_space="camera", normal_side="outward")


@scene
def background_zero() -> Document:
    """A number behind everything, for Z, T and ZBack alike."""
    return document(QUADRICS, pinhole(), background_depth=0)


@scene
def background_beyond_float32() -> Document:
    """A background that float32 cannot hold."""
    return document(QUADRICS, pinhole(), background_depth=1e300)


@scene
def tight_window() -> Document:
    """The hits' bounding box."""
    ball = {"shape": "sphere", "center": [1, 0.5, -4], "radius": 0.5}
    return document([ball], pinhole(width=40, height=40, fx=40, fy=40), data_window="tight")


@scene
def tight_window_in_a_crop() -> Document:
    """The bounding box of what the crop leaves."""
    ball = {"shape": "sphere", "center": [0, 0, -4], "radius": 1}
    camera = pinhole(width=40, height=40, fx=40, fy=40, crop=[5, 6, 22, 18])
    return document([ball], camera, data_window="tight")


@scene
def tight_window_around_nothing() -> Document:
    """No hit: one pixel at the window's top left corner."""
    ball = {"shape": "sphere", "center": [0, 0, 4]}
    return document([ball], pinhole(crop=[5, 6, 22, 14]), data_window="tight")


@scene
def half_normals() -> Document:
    """N rounded to half from what a float would have held."""
    return document(QUADRICS, pinhole(), half_normals=True)


@scene
def depth_alone() -> Document:
    """One channel: the shading is not there at all."""
    return document(QUADRICS, pinhole(), channels=["Z"])


@scene
def ids_alone() -> Document:
    """No float channel."""
    return document(QUADRICS, orthographic(), channels=["id"])


@scene
def normals_alone() -> Document:
    """Normals without depth."""
    return document(QUADRICS, pinhole(), channels=["N"])


@scene
def backs_alone() -> Document:
    """ZBack without Z."""
    return document(QUADRICS, pinhole(), channels=["ZBack", "A"])


@scene
def nothing_in_view() -> Document:
    """No quadric reaches the image."""
    return document([{"shape": "sphere", "center": [50, 0, -4]}], pinhole())


@only_exact
def grazing_normals() -> Document:
    """A normal that is exactly at right angles to the ray takes the outward side, without -0."""
    camera = orthographic(fx=4, fy=4, cx=12.5, cy=8.5)
    del camera["view_height"]
    return document([{"shape": "sphere", "center": [0, 0, -4], "radius": 1.25}], camera, normal_space="camera")
