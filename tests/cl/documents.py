"""Hypothesis strategies for valid scene documents, as Python values that `json.dumps` turns into one."""

from typing import Any

from hypothesis import strategies as st

from conicoid.shapes import SHAPES, Shape

Json = dict[str, Any]

finite = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**20), 10**20)
positive = st.floats(min_value=5e-324, allow_infinity=False) | st.integers(1, 10**20)
# Where numbers are multiplied or compared, extremes are drawn on purpose and the rest is ordinary.
ordinary = st.floats(-1e3, 1e3) | st.integers(-10, 10)


def lists(number: st.SearchStrategy[Any], length: int) -> st.SearchStrategy[list[Any]]:
    return st.lists(number, min_size=length, max_size=length)


def nonzero(number: st.SearchStrategy[Any], length: int) -> st.SearchStrategy[list[Any]]:
    return lists(number, length).filter(any)


@st.composite
def transforms(draw: st.DrawFn) -> list[list[Any]]:
    """Invertible by construction: a unit lower triangle times an upper one with a diagonal other than zero."""
    whole = st.integers(-4, 4)
    lower = [[1, 0, 0], [draw(whole), 1, 0], [draw(whole), draw(whole), 1]]
    diagonal = [draw(whole.filter(bool)) * 2.0 ** draw(st.integers(-300, 300)) for _ in range(3)]
    upper = [[diagonal[0], draw(whole), draw(whole)], [0, diagonal[1], draw(whole)], [0, 0, diagonal[2]]]
    linear = [[sum(lower[i][k] * upper[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    if not _triangular_enough(diagonal):
        linear = upper
    return [[*row, draw(finite)] for row in linear] + [[0, 0, 0, 1]]


def _triangular_enough(diagonal: list[float]) -> bool:
    """Whether the products of `transforms` are exact, so that rounding cannot make them singular."""
    return all(2.0**-40 <= abs(entry) <= 2.0**40 for entry in diagonal)


@st.composite
def matrices(draw: st.DrawFn) -> list[list[Any]]:
    entries = draw(nonzero(finite, 10))
    order = [[0, 1, 2, 3], [1, 4, 5, 6], [2, 5, 7, 8], [3, 6, 8, 9]]
    return [[entries[k] for k in row] for row in order]


def values(shape: Shape) -> dict[str, st.SearchStrategy[Any]]:
    """Strategies for one value of every key that a shape takes."""
    parameters: dict[str, st.SearchStrategy[Any]] = {}
    if shape.name == "quadric":
        parameters = {"matrix": matrices(), "coefficients": nonzero(finite, 10)}
    if shape.radius:
        parameters["radius"] = positive
    if shape.radii > 1:
        parameters["radii"] = lists(positive, shape.radii)
    return parameters | {
        "transform": transforms(),
        "center": lists(finite, 3),
        "rotation": nonzero(finite, 4),
        "z_range": lists(finite, 2).map(sorted),
        "clip": st.lists(lists(finite, 4), max_size=8),
        "id": st.integers(1, 2**32 - 1),
        "name": st.text(max_size=5),
        "capped": st.booleans(),
    }


@st.composite
def keys(draw: st.DrawFn, shape: Shape) -> set[str]:
    """Keys of a shape that may stand together, besides `shape` itself."""
    choices = {"matrix", "coefficients"} if shape.name == "quadric" else {"radius", "radii", ""}
    placed = {"center", "rotation"} if draw(st.booleans()) else {"transform"}
    able = {draw(st.sampled_from(sorted(choices & {*values(shape), ""})))} - {""}
    optional = draw(st.sets(st.sampled_from(sorted({*placed, "z_range", "clip", "id", "name", "capped"}))))
    return able | (optional if "z_range" in optional else optional - {"capped"})


@st.composite
def quadrics(draw: st.DrawFn) -> Json:
    shape = draw(st.sampled_from(SHAPES))
    kinds = values(shape)
    return {"shape": shape.name} | {key: draw(kinds[key]) for key in sorted(draw(keys(shape)))}


@st.composite
def sets(draw: st.DrawFn) -> tuple[Json, list[Json]]:
    """A set, and its quadrics as entries of their own."""
    shape = draw(st.sampled_from(SHAPES))
    kinds, count = values(shape), draw(st.integers(0, 4))
    entry: Json = {"shape": shape.name, "count": count}
    elements: list[Json] = [{"shape": shape.name} for _ in range(count)]
    for key in sorted(draw(keys(shape))):
        if draw(st.booleans()):
            entry[key] = [draw(kinds[key]) for _ in range(count)]
            each = entry[key]
        elif key == "id":
            entry[key] = draw(st.integers(1, 2**32 - max(1, count)))
            each = range(entry[key], entry[key] + count)
        else:
            entry[key] = draw(kinds[key])
            each = [entry[key]] * count
        for element, value in zip(elements, each, strict=True):
            element[key] = value
    return entry, elements


def rotations_by_quarters() -> st.SearchStrategy[list[list[int]]]:
    """Matrices of turns by multiples of 90 degrees about z, and of the axes in a circle."""
    return st.sampled_from(
        [
            [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
            [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
            [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
            [[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [-0.0, 0.0, 1.0]],
        ]
    )


@st.composite
def cameras(draw: st.DrawFn) -> Json:
    width, height = draw(st.integers(1, 300)), draw(st.integers(1, 300))
    camera: Json = {"width": width, "height": height}
    angle = st.floats(1e-6, 180, exclude_max=True)
    scale = st.floats(1e-100, 1e100)
    if draw(st.booleans()):
        camera["projection"] = "orthographic"
        camera |= draw(st.sampled_from([{"view_height": 2.5}, {"view_height": 3}, {"fx": 4, "fy": 5.5}]))
    else:
        key = draw(st.sampled_from(["fov_x", "fov_y", "fx"]))
        camera |= {"fx": draw(scale), "fy": draw(scale)} if key == "fx" else {key: draw(angle)}
    if draw(st.booleans()):
        camera["convention"] = draw(st.sampled_from(["opengl", "opencv"]))
        linear = draw(rotations_by_quarters())
        camera["world_from_camera"] = [[*row, draw(finite)] for row in linear] + [[0, 0, 0, 1]]
    elif draw(st.booleans()):
        x, y, z = draw(lists(ordinary, 3))
        camera["look_at"] = {"eye": [x, y, z + 5], "target": [x + 1, y, z], "up": [0, 1e200, 0]}
    camera |= draw(st.fixed_dictionaries({}, optional={"cx": finite, "cy": finite}))
    depths = sorted(abs(depth) for depth in draw(lists(finite, 2)))
    camera |= draw(
        st.sampled_from([{}, {"near": depths[0]}, {"far": depths[1]}, {"near": depths[0], "far": depths[1]}])
    )
    if draw(st.booleans()):
        x0, y0 = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
        camera["crop"] = [x0, y0, draw(st.integers(x0 + 1, width)), draw(st.integers(y0 + 1, height))]
    return camera


outputs = st.fixed_dictionaries(
    {},
    optional={
        "channels": st.lists(st.sampled_from(["Z", "T", "ZBack", "N", "P", "id", "A"]), min_size=1, unique=True),
        "normal_space": st.sampled_from(["world", "camera"]),
        "normal_side": st.sampled_from(["facing", "outward"]),
        "background_depth": st.just("inf") | finite,
        "precision": st.sampled_from(["exact", "float64", "float32"]),
        "compression": st.sampled_from(["zip", "none", "rle", "zips", "piz", "zstd"]),
        "data_window": st.sampled_from(["full", "tight"]),
        "half_normals": st.booleans(),
    },
)
entries = quadrics() | sets().map(lambda pair: pair[0])
documents = st.fixed_dictionaries(
    {"conicoid": st.just(1), "quadrics": st.lists(entries, max_size=6), "camera": cameras()},
    optional={"output": outputs},
)


@st.composite
def documents_and_expansions(draw: st.DrawFn) -> tuple[Json, Json]:
    """A document with sets, and the same with every set written out."""
    pairs = draw(st.lists(sets() | quadrics().map(lambda one: (one, [one])), min_size=1, max_size=6))
    document = draw(st.fixed_dictionaries({"conicoid": st.just(1), "camera": cameras()}))
    expansion = [element for _, elements in pairs for element in elements]
    return document | {"quadrics": [entry for entry, _ in pairs]}, document | {"quadrics": expansion}
