"""Where the camera is and how it looks: inside, on surfaces, on cap planes; near, far, crop, lenses, conventions."""

from tests.scenes.catalogue import Document, document, orthographic, pinhole, scene

BALL = {"shape": "sphere", "center": [0, 0, -4], "radius": 1.5}
CAN = {"shape": "cylinder", "center": [0, 0, -4], "rotation": [1, 0, 0, 1], "z_range": [-1, 1], "capped": True}
BACKWARDS = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]


@scene
def inside_a_sphere() -> Document:
    """c < 0: every ray hits once, and facing normals point inwards."""
    return document([{"shape": "ellipsoid", "radii": [2, 1.5, 3], "center": [0.25, 0.5, -1]}], pinhole())


@scene
def inside_a_sphere_looking_outward() -> Document:
    """The outward normal, seen from inside, points away from the eye."""
    return document([{"shape": "sphere", "radius": 3}], pinhole(), normal_side="outward")


@scene
def inside_a_capped_cylinder() -> Document:
    """Walls by second roots, and both caps from behind."""
    quadric = {"shape": "cylinder", "rotation": [0.25, 0, 0, 1], "z_range": [-2, 3], "capped": True}
    return document([quadric], pinhole(fx=8, fy=8))


@scene
def eye_on_a_sphere_looking_in() -> Document:
    """c = 0: the root at the eye does not count, the other does."""
    return document([{"shape": "sphere", "center": [0, 0, -1]}], pinhole())


@scene
def eye_on_a_sphere_looking_out() -> Document:
    """c = 0 with the ball behind: nothing is hit."""
    return document([{"shape": "sphere", "center": [0, 0, 1]}], pinhole())


@scene
def eye_on_a_sphere_looking_along_it() -> Document:
    """c = 0 and half of the rays enter the ball; the horizon passes between the rows."""
    return document([{"shape": "sphere", "center": [0, -1, 0]}], pinhole())


@scene
def horizon_through_pixel_centres() -> Document:
    """c = 0 and the rays of one row are tangent at the eye itself: t = 0 does not count."""
    return document([{"shape": "sphere", "center": [0, -1, 0]}], pinhole(cx=12.5, cy=8.5))


@scene
def eye_at_a_cone_apex() -> Document:
    """b = c = 0 on every ray: rays leave at t = 0, those along the cone lie in it."""
    quadric = {"shape": "cone", "rotation": [0, 1, 0, 1], "z_range": [-2, 2], "capped": True}
    return document([quadric], pinhole(fx=8, fy=8))


@scene
def eye_on_a_plane() -> Document:
    """b = c = 0 for a plane through the eye: nothing is hit."""
    return document([{"shape": "plane", "rotation": [1, 0.25, 0, 1]}], pinhole(cx=12.5, cy=8.5))


@scene
def eye_on_a_cap_plane() -> Document:
    """The eye in the plane of a cap, beside it: the cap is missed, its edge shows."""
    return document([{**CAN, "center": [0, 1, -4]}, {**CAN, "center": [0, -1, -4], "z_range": [-1, 0.5]}], pinhole())


@scene
def eye_on_a_cap() -> Document:
    """The eye on the cap itself, looking in: t = 0 does not count, the inside does."""
    return document([{"shape": "cylinder", "radius": 1.5, "z_range": [-3, 0], "capped": True}], pinhole(fx=8, fy=8))


@scene
def orthographic_start_inside() -> Document:
    """Rays that start inside, on and outside of a ball."""
    return document([{"shape": "sphere", "center": [0.25, 0, -0.5], "radius": 1.25}], orthographic())


@scene
def everything_behind() -> Document:
    """Both roots negative for all quadrics."""
    return document([BALL, CAN], pinhole(world_from_camera=BACKWARDS))


@scene
def near_opens_a_sphere() -> Document:
    """The first root is in front of near: the inside shows, by the second."""
    return document([BALL], pinhole(near=3.25))


@scene
def far_halves_a_sphere() -> Document:
    """Second roots and rims are beyond far."""
    return document([BALL], orthographic(far=3.5))


@scene
def near_is_the_depth() -> Document:
    """A plane exactly at near is kept: the range is closed."""
    planes = [{"shape": "plane", "center": [0, 0, -3]}, {"shape": "plane", "center": [0, 0, -4]}]
    return document(planes, pinhole(near=3, far=3))


@scene
def far_is_the_depth() -> Document:
    """Both faces of a slab lie exactly at near and far."""
    return document([{"shape": "parallel_planes", "center": [0, 0, -4]}], orthographic(near=3, far=5))


@scene
def clip_through_pixel_centres() -> Document:
    """A clip plane through the eye, which holds rays of one column: half-spaces are closed."""
    return document([{**BALL, "clip": [[-1, 0, 0, 0]]}], pinhole(cx=12.5, cy=8.5))


@scene
def eight_clips() -> Document:
    """As many half-spaces as may be, cutting a ball to a brick."""
    sides = [[1, 0, 0, 1.25], [-1, 0, 0, 1.25], [0, 1, 0, 1], [0, -1, 0, 1], [0, 0, 1, 5.25], [0, 0, -1, -2.75]]
    corners = [[1, 1, 0, 1.5], [-1, -1, 0.5, 3.5]]
    return document([{**BALL, "clip": [*sides, *corners]}], pinhole())


@scene
def caps_are_clipped() -> Document:
    """A half-space cuts the caps of a can in two."""
    return document([{**CAN, "rotation": [0.5, 0, 0, 1], "clip": [[1, 0, 0, 0.125]]}], pinhole())


@scene
def crop() -> Document:
    """A window with odd corners, in an image larger than a tile."""
    return document(
        [BALL, {**CAN, "center": [1, 1, -3]}], pinhole(width=64, height=48, fx=40, fy=40, crop=[13, 7, 50, 40])
    )


@scene
def crop_of_one_pixel() -> Document:
    """The smallest window, in the last corner."""
    return document([{**BALL, "radius": 3.5}], orthographic(crop=[23, 15, 24, 16]))


@scene
def tall_image() -> Document:
    """More rows than columns, neither a multiple of a tile."""
    return document([BALL, CAN], pinhole(width=19, height=45))


@scene
def oblong_pixels() -> Document:
    """fx is not fy."""
    return document([BALL, CAN], pinhole(fx=31.25, fy=11.5))


@scene
def principal_point_outside() -> Document:
    """An off-axis camera: the axis of view is not in the image."""
    return document([{**BALL, "center": [3, -2, -4]}], pinhole(cx=-4.3, cy=-2.7))


@scene
def very_wide_angle() -> Document:
    """160 degrees: rays run almost sideways."""
    camera = {"width": 48, "height": 32, "fov_x": 160}
    return document([BALL, {"shape": "plane", "rotation": [1, 0, 0, 1], "center": [0, -1, 0]}], camera)


@scene
def very_long_lens() -> Document:
    """A hundredth of a degree, at a ball 10,000 away."""
    camera = {"width": 24, "height": 16, "fov_y": 0.01}
    return document([{"shape": "sphere", "center": [0, 0, -10000], "radius": 0.75}], camera)


@scene
def look_at() -> Document:
    """A pose from eye, target and up, whose rotation is orthogonal only to rounding."""
    pose = {"eye": [3, 2, 1], "target": [0, 0, -4], "up": [0, 1, 0]}
    return document([BALL, CAN], {"width": 24, "height": 16, "fov_y": 40, "look_at": pose})


@scene
def look_at_in_opencv_axes() -> Document:
    """look_at sees the same under either convention."""
    pose = {"eye": [3, 2, 1], "target": [0, 0, -4], "up": [0, 1, 0]}
    camera = {"width": 24, "height": 16, "fov_y": 40, "convention": "opencv", "look_at": pose}
    return document([BALL, CAN], camera)


@scene
def opencv_axes() -> Document:
    """Looks down +z with +y down."""
    pose = [[0.6, 0, 0.8, -1], [0, 1, 0, 0.25], [-0.8, 0, 0.6, 0], [0, 0, 0, 1]]
    ball = {"shape": "ellipsoid", "radii": [1, 0.5, 1], "center": [2, 1, 3]}
    return document([ball], pinhole(convention="opencv", world_from_camera=pose), normal_space="camera")


@scene
def pose_not_quite_orthogonal() -> Document:
    """A rotation off by 5e-7 is taken as it stands."""
    pose = [[1, 4e-7, 0, 0], [0, 1.0000002, 1e-7, 0], [-3e-7, 0, 0.9999998, 0], [0, 0, 0, 1]]
    return document([BALL, CAN], pinhole(world_from_camera=pose), normal_space="camera")


@scene
def orthographic_look_at() -> Document:
    """Parallel rays in a general direction."""
    pose = {"eye": [4, 3, 2], "target": [0, 0, -4], "up": [0.1, 1, 0]}
    camera = {"projection": "orthographic", "width": 32, "height": 24, "view_height": 4.5, "look_at": pose}
    return document([BALL, CAN], camera, normal_space="camera", normal_side="outward")
