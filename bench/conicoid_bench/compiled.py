"""Ellipsoids in Python that numba compiles: boxes and lists of tiles, then every tile on its own, its rows as vectors.

The rays are those that `whole.moved_camera` allows, from the origin along (x, y, -1). The steps are plain Python on
NumPy arrays: without numba they give the same, some thousand times slower.
"""

from collections.abc import Callable
from math import ceil, floor, inf, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from conicoid.scene import Scene
from conicoid_bench.picture import Job, Picture
from conicoid_bench.whole import more_than_whole, moved_camera, records

TILE: Final = 16
Step = Callable[..., None]
Values = NDArray[np.float32]
_F = np.float32  # a constant without a type would make binary64 of everything that it meets


class Numba:
    """Boxes, order and tile lists are built again in each lap, as they depend on the camera.

    Args:
        spread: makes of step(k, ...) one that takes a number instead and does it for every k below.
    Raises:
        ImportError: numba is not installed.
    """

    name = "numba"

    def __init__(self, spread: Callable[[Step], Step] | None = None) -> None:
        made = spread or parallel
        self._set_up, self._list, self._trace = made(set_up), made(list_tiles), made(trace_tile)

    def why_not(self, scene: Scene) -> str | None:
        """It takes whole ellipsoids seen from the origin."""
        return more_than_whole(scene) or moved_camera(scene)

    def prepare(self, scene: Scene) -> Job:
        """Arrays; the rest is built or cast."""
        camera = scene.camera
        count, width, height = len(scene.quadrics), camera.width, camera.height
        lens, source = np.array([camera.fx, camera.fy, camera.cx, camera.cy]), records(scene)
        rows, near, box = np.empty((count, 12), _F), np.empty(count, _F), np.empty((count, 4), np.int32)
        columns, tiles = -(-width // TILE), -(-width // TILE) * -(-height // TILE)
        start = np.zeros(tiles + 1, np.int64)
        depth, normal = np.empty((height, width), _F), np.empty((height, width, 3), _F)
        seen = np.empty((height, width), np.int32)
        lists = [np.empty(0, np.int32)]

        def build() -> None:
            self._set_up(count, source, lens, width, height, rows, near, box)
            low, high = box[:, :2] // TILE, -(-box[:, 2:] // TILE)
            lists[0] = np.empty(int((high - low).prod(axis=1, dtype=np.int64).sum()), np.int32)
            self._list(1, np.argsort(near), np.concatenate([low, high], axis=1), columns, start[1:], lists[0])

        def run(numbers: bool = False) -> None:
            self._trace(tiles, rows, near, box, lens.astype(_F), start, lists[0], depth, normal, seen, numbers)

        def picture(_: None) -> Picture:
            run(numbers=True)
            ids = np.concatenate([[0], scene.quadrics.id]).astype(np.uint32)
            return Picture(depth.copy(), ids[seen + 1], normal.copy())

        build()
        return Job(run, picture, build)


def parallel(step: Step) -> Step:
    """Compiled, and spread over all cores."""
    import numba

    compiled = numba.njit(step, error_model="numpy", fastmath={"contract", "nsz", "arcp"})

    def every(count: int, *arguments: Any) -> None:
        for k in numba.prange(count):
            compiled(k, *arguments)

    spread: Step = numba.njit(every, parallel=True)
    return spread


def serial(step: Step) -> Step:
    """One after the other, as Python runs it."""

    def every(count: int, *arguments: Any) -> None:
        for k in range(count):
            step(k, *arguments)

    return every


def set_up(k: int, source: Any, lens: Any, width: int, height: int, rows: Any, near: Any, box: Any) -> None:
    """Of ellipsoid k: the unit sphere's space from the camera's, nearest depth, half-open pixel box (empty: not seen).

    The box's sides are planes through the eye that touch it: n' (L L' - c c') n = 0 for n = (1, 0, u), (0, 1, v).
    """
    for i in range(3):
        rows[k, 9 + i] = source[k, i]
        for j in range(3):
            rows[k, 3 * i + j] = source[k, 6 + 3 * j + i] / source[k, 3 + i]
    zz = 0.0
    for j in range(3):
        zz += (source[k, 12 + j] * source[k, 3 + j]) ** 2
    z = source[k, 2]
    near[k] = -z - sqrt(zz)
    for axis in range(2):
        size = height if axis else width
        low, high = 0.0, float(size)
        across, mixed, c = 0.0, 0.0, source[k, axis]
        for j in range(3):
            reach = source[k, 6 + 3 * axis + j] * source[k, 3 + j]
            across += reach * reach
            mixed += reach * source[k, 12 + j] * source[k, 3 + j]
        p, q, r = zz - z * z, mixed - c * z, across - c * c
        if p < 0 and z < 0:
            root = sqrt(max(q * q - p * r, 0.0))
            first, last = (-q + root) / p, (-q - root) / p
            sign = -1.0 if axis else 1.0
            ends = lens[axis] * sign * first + lens[2 + axis], lens[axis] * sign * last + lens[2 + axis]
            low, high = min(max(min(ends), low), high), max(min(max(ends), high), low)
        elif z > 0 and p < 0:
            high = low
        box[k, axis], box[k, 2 + axis] = floor(low), ceil(high)


def list_tiles(_: int, order: Any, tile_box: Any, columns: int, end: Any, entries: Any) -> None:
    """Which ellipsoids each tile may see, nearest first: where each list ends, and all lists one after the other."""
    end[:] = 0
    for k in range(len(tile_box)):
        for row in range(tile_box[k, 1], tile_box[k, 3]):
            for column in range(tile_box[k, 0], tile_box[k, 2]):
                end[row * columns + column] += 1
    total = 0
    for tile in range(len(end)):
        many = end[tile]
        end[tile] = total
        total += many
    for k in order:
        for row in range(tile_box[k, 1], tile_box[k, 3]):
            for column in range(tile_box[k, 0], tile_box[k, 2]):
                entries[end[row * columns + column]] = k
                end[row * columns + column] += 1


def trace_tile(
    tile: int, rows: Any, near: Any, box: Any, lens: Any, start: Any, entries: Any, depths: Any, normals: Any,
    seen: Any, numbers: bool,
) -> None:  # fmt: skip
    """One tile: quadric by quadric, then normals of what is seen; `seen` where `numbers` are wanted.

    A ray is taken from where it crosses the centre's plane of depth, then from its closest approach, so that nothing
    is larger than the ellipsoid: binary32 is enough for most pixels.
    """
    height, width = depths.shape
    columns = -(-width // TILE)
    top, left = tile // columns * TILE, tile % columns * TILE
    depth, number = np.full(TILE * TILE, _F(inf)), np.full(TILE * TILE, np.int32(-1))
    x = np.empty(TILE, _F)
    for i in range(TILE):
        x[i] = (_F(left + i) + _F(0.5) - lens[2]) / lens[0]
    for place in range(start[tile], start[tile + 1]):
        k = entries[place]
        # The deepest of 256 pixels costs as much as a row or two: it is looked for now and then.
        if (place - start[tile]) % 8 == 0 and near[k] > depth.max():
            break
        m00, m01, m02, m10, m11, m12, m20, m21, m22 = (
            rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5], rows[k, 6], rows[k, 7], rows[k, 8]
        )  # fmt: skip
        c, at = rows[k, 9], -rows[k, 11]
        for j in range(max(box[k, 1] - top, 0), min(box[k, 3] - top, TILE)):
            y = -(_F(top + j) + _F(0.5) - lens[3]) / lens[1]
            up = at * y - rows[k, 10]
            for i in range(TILE):
                across = at * x[i] - c
                ox, oy, oz = m00 * across + m01 * up, m10 * across + m11 * up, m20 * across + m21 * up
                dx, dy, dz = m00 * x[i] + (m01 * y - m02), m10 * x[i] + (m11 * y - m12), m20 * x[i] + (m21 * y - m22)
                a = dx * dx + dy * dy + dz * dz
                approach = (ox * dx + oy * dy + oz * dz) / a
                ox, oy, oz = ox - approach * dx, oy - approach * dy, oz - approach * dz
                inside = _F(1) - (ox * ox + oy * oy + oz * oz)
                t = at - approach - _F(sqrt(max(inside, _F(0)) / a))
                nearer = (inside >= _F(0)) & (t > _F(0)) & (t < depth[TILE * j + i])
                depth[TILE * j + i] = t if nearer else depth[TILE * j + i]
                number[TILE * j + i] = k if nearer else number[TILE * j + i]
    for j in range(min(TILE, height - top)):
        y = -(_F(top + j) + _F(0.5) - lens[3]) / lens[1]
        for i in range(min(TILE, width - left)):
            k, t = number[TILE * j + i], depth[TILE * j + i]
            depths[top + j, left + i] = t
            if numbers:
                seen[top + j, left + i] = k
            nx, ny, nz = _F(0), _F(0), _F(0)
            if k >= 0:
                px, py, pz = t * x[i] - rows[k, 9], t * y - rows[k, 10], -t - rows[k, 11]
                gx = rows[k, 0] * px + rows[k, 1] * py + rows[k, 2] * pz
                gy = rows[k, 3] * px + rows[k, 4] * py + rows[k, 5] * pz
                gz = rows[k, 6] * px + rows[k, 7] * py + rows[k, 8] * pz
                nx = rows[k, 0] * gx + rows[k, 3] * gy + rows[k, 6] * gz
                ny = rows[k, 1] * gx + rows[k, 4] * gy + rows[k, 7] * gz
                nz = rows[k, 2] * gx + rows[k, 5] * gy + rows[k, 8] * gz
                scale = _F(1) / _F(sqrt(nx * nx + ny * ny + nz * nz))
                nx, ny, nz = nx * scale, ny * scale, nz * scale
            normals[top + j, left + i, 0] = nx
            normals[top + j, left + i, 1] = ny
            normals[top + j, left + i, 2] = nz
