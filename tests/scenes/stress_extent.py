"""Ranges, caps, clips, near and far where they meet surfaces, silhouettes and each other."""

from tests.scenes.catalogue import Document
from tests.scenes.stress import CENTRED, UPRIGHT, ball, enter, form, orthographic, pinhole, stress, up

# Seen along the axis: what S says of the surface says nothing of the caps.
ALONG: dict[str, tuple[str, Document]] = {
    "cylinder": ("a = b = S = 0 at every pixel", {"radii": [1.25, 1]}),
    "cone": ("a = -1 everywhere, both caps are discs of other sizes", {"radii": [1, 0.75]}),
    "paraboloid": ("a = 0 everywhere", {"radii": [1.5, 1]}),
    "hyperbolic_paraboloid": ("a = 0 everywhere, caps bounded by hyperbolas", {"radii": [1, 0.75]}),
    "hyperboloid_one_sheet": ("caps are hit where S < 0", {"radii": [0.75, 0.5, 0.5]}),
    "hyperboloid_two_sheets": ("both sheets behind their caps", {"radii": [1, 0.75, 0.25]}),
    "parabolic_cylinder": ("caps without an end in y", {"radius": 1.25}),
    "hyperbolic_cylinder": ("caps in two parts", {"radii": [0.75, 0.5]}),
    "crossed_planes": ("a double wedge with its edge along the view", {"radii": [1, 0.75]}),
    "sphere": ("a slice of a ball", {"radius": 1.25}),
}
for shape, (reason, parameters) in ALONG.items():
    quadric = {"shape": shape, **parameters, "center": [0, 0, -4], "z_range": [-0.75, 0.5], "capped": True}
    enter(
        f"{shape}_along_the_view", f"capped, orthographic, along its axis: {reason}", [quadric], orthographic(**CENTRED)
    )
    enter(f"{shape}_down_the_axis", f"capped, from a point of its axis: {reason} in the middle", [quadric],
          pinhole(**CENTRED))  # fmt: skip


for capped in (False, True):
    enter(f"flat_cans_{'capped' if capped else 'bare'}",
          "z0 = z1: a circle without caps, one disc with them; at the waist, the pole and the apex",
          [{"shape": "sphere", "center": [-1, 0, -4], "rotation": [0.6, 0, 0, 1], "z_range": [0, 0], "capped": capped},
           {"shape": "sphere", "radius": 0.5, "transform": UPRIGHT, "z_range": [0.5, 0.5], "capped": capped},
           {"shape": "cone", "center": [1, 0, -4], "rotation": [-0.4, 0, 0, 1], "z_range": [0, 0], "capped": capped},
           {"shape": "cylinder", "radius": 0.75, "center": [1, 0, -5], "rotation": [0.9, 0, 0, 1],
            "z_range": [0.3, 0.3], "capped": capped}], pinhole(**CENTRED))  # fmt: skip


@stress
def range_of_one_unit() -> tuple[list[Document], Document]:
    """z1 is the number after z0: a ring of 2^-52, two caps that no depth tells apart."""
    return [{"shape": "cylinder", "center": [0, 0, -4], "rotation": [0.7, 0, 0, 1], "z_range": [1, up(1.0)],
             "capped": True}], pinhole()  # fmt: skip


@stress
def cap_through_the_eye() -> tuple[list[Document], Document]:
    """The eye in the plane of a cap: rays of one row lie within it."""
    return [{"shape": "cylinder", "center": [0, 0, -4], "rotation": [1, 0, 0, 1], "z_range": [-1, 0],
             "capped": True}], pinhole(**CENTRED)  # fmt: skip


@stress
def cap_on_the_silhouette() -> tuple[list[Document], Document]:
    """A ball cut at its equator as seen: the rim of the cap is the silhouette."""
    return [
        ball(0, 0, -4, 1.25, z_range=[0, 1.25], capped=True),
        ball(0, 0, -6, 1.25, z_range=[-1.25, 0], capped=True),
    ], orthographic(**CENTRED)


@stress
def clip_through_the_silhouette() -> tuple[list[Document], Document]:
    """Half-spaces through the circle where rays are tangent, from both sides."""
    return [ball(-1, 0, -4, 0.75, clip=[[0, 0, 1, 4]]), ball(1, 0, -4, 0.75, clip=[[0, 0, -1, -4]])], orthographic(
        **CENTRED
    )


@stress
def clip_on_a_cap() -> tuple[list[Document], Document]:
    """Clips that are the planes of the caps: closed, so the caps stay."""
    return [{"shape": "cylinder", "center": [0, 0, -4], "z_range": [-0.5, 0.5], "capped": True,
             "clip": [[0, 0, -1, -3.5], [0, 0, 1, 4.5]]}], pinhole(**CENTRED)  # fmt: skip


@stress
def clip_a_unit_off_a_cap() -> tuple[list[Document], Document]:
    """The near cap is cut off by one unit in the last place, and what is behind it shows."""
    return [{"shape": "cylinder", "center": [0, 0, -4], "z_range": [-0.5, 0.5], "capped": True,
             "clip": [[0, 0, -1, up(-3.5, -1)]]}], pinhole(**CENTRED)  # fmt: skip


@stress
def clip_tangent_to_a_ball() -> tuple[list[Document], Document]:
    """A half-space that keeps one point of a ball, the one that the middle ray meets."""
    return [ball(0, 0, -4, 1, clip=[[0, 0, 1, 3]])], pinhole(**CENTRED)


@stress
def clips_through_pixel_centres() -> tuple[list[Document], Document]:
    """Planes through the eye and through rows and columns of pixel centres, with thirds in them."""
    clips = [[1, 0, 0, 0], [0, 1, 0, 0], [3, -1, 0, 0], [1, 1, 1 / 3, 0]]
    return [ball(0, 0, -4, 1.75, clip=clips[:2]), ball(0, 0, -6, 2.5, clip=clips[2:])], pinhole(fx=12, **CENTRED)


@stress
def a_wedge_of_no_width() -> tuple[list[Document], Document]:
    """Two opposite half-spaces: what they share is a plane, and the rays within it."""
    return [ball(0, 0, -4, 1.5, clip=[[1, 0, 0, 0], [-1, 0, 0, 0]])], pinhole(**CENTRED)


@stress
def clip_of_all_sizes() -> tuple[list[Document], Document]:
    """Half-spaces whose numbers are 1e±200 times others: only their sign counts."""
    return [ball(0, 0, -4, 1.5, clip=[[1e-200, 0, 0, 0.3e-200], [0, 1e200, 0.25e200, 1.2e200]])], pinhole()


@stress
def clip_far_from_the_origin() -> tuple[list[Document], Document]:
    """A plane through (1e9, 1e9, -1e9 - 4) and along the view: d cancels all but the last bits."""
    far = 1e9
    clip = [0.6, 0.8, 0, -1.4 * far - 0.05]
    pose = [[1, 0, 0, far], [0, 1, 0, far], [0, 0, 1, -far], [0, 0, 0, 1]]
    return [ball(far, far, -far - 4, 1.5, clip=[clip])], orthographic(world_from_camera=pose)


for label, depth in (("at", 2.75), ("after", up(2.75)), ("before", up(2.75, -1))):
    enter(f"near_{label}_a_pole", f"near = {depth!r} on a ball whose nearest point is 2.75 away",
          [ball(0, 0, -4, 1.25)], pinhole(near=depth, **CENTRED))  # fmt: skip
    enter(f"far_{label}_a_pole", f"far = {depth!r} on the same ball", [ball(0, 0, -4, 1.25)],
          orthographic(far=depth, **CENTRED))  # fmt: skip
    enter(f"near_and_far_{label}_a_cap", f"near = far = {depth!r}: the cap at 2.75 alone could be kept",
          [{"shape": "cylinder", "radius": 1.25, "center": [0, 0, -4], "z_range": [-1, 1.25], "capped": True}],
          pinhole(near=depth, far=depth, **CENTRED))  # fmt: skip


@stress
def far_is_the_equator() -> tuple[list[Document], Document]:
    """far at the depth of the silhouette of parallel rays: tangent points are kept."""
    return [ball(0, 0, -4, 1.25)], orthographic(far=4, **CENTRED)


@stress
def near_in_thirds() -> tuple[list[Document], Document]:
    """A slanted plane crosses near along pixel centres: 1 - x/3 against rounded numbers."""
    return [form(0, 0, 0, 1, 0, 0, 0, 0, 3, 12.5)], orthographic(fx=3, fy=3, near=4 + 1 / 6, **CENTRED)


@stress
def caps_that_touch_the_surface() -> tuple[list[Document], Document]:
    """A cone capped at its apex and a paraboloid at its vertex, along the axis: caps of one point."""
    return [
        {"shape": "cone", "center": [-0.75, 0, -4], "z_range": [-0.75, 0], "capped": True, "radius": 0.5},
        {"shape": "paraboloid", "center": [1, 0, -4], "z_range": [0, 0.75], "capped": True},
    ], orthographic(**CENTRED)


@stress
def disc_between_half_balls() -> tuple[list[Document], Document]:
    """Two half-balls and the disc between them: three caps in one plane."""
    common = {"center": [0, 0, -4], "rotation": [0.5, 0.25, 0, 1], "capped": True}
    return [{"shape": "sphere", "z_range": [-1, 0], **common}, {"shape": "sphere", "z_range": [0, 1], **common},
            {"shape": "cylinder", "radius": 1.25, "z_range": [0, 0], **common}], pinhole()  # fmt: skip
