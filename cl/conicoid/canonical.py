"""The canonical form of a scene: the document that says all of it, and the hash of its exact numbers."""

import hashlib
from dataclasses import asdict
from typing import Any

import numpy as np
import orjson

from conicoid.collector import paused_collector
from conicoid.scene import Camera, Floats, KeptSet, Output, Quadrics, Scene
from conicoid.shapes import SHAPES, Shape


def canonical_document(scene: Scene) -> dict[str, Any]:
    """The scene as a document with every number derived and every default filled in; its own canonical form.

    Keys come in a fixed order. Keys whose absence has a meaning of its own (`z_range`, `capped`, `clip`, `name`, `far`)
    are there only where they say something. A set of more than `scene.MOST_EXPANDED` quadrics stays a set: `count`, and
    for every other key a NumPy array, or a list, of one value for each.
    """
    return _document(scene.quadrics, {"camera": camera_document(scene.camera)}, scene.output)


def canonical_bytes(scene: Scene) -> bytes:
    """The canonical document as compact UTF-8 JSON with shortest round-trip floats and a newline at the end."""
    return _json(canonical_document(scene))


def canonical_batch_bytes(quadrics: Quadrics, cameras: list[Camera], output: Output) -> bytes:
    """The same of a document with `cameras`."""
    return _json(_document(quadrics, {"cameras": list(map(camera_document, cameras))}, output))


def _document(quadrics: Quadrics, views: dict[str, Any], output: Output) -> dict[str, Any]:
    with paused_collector():
        return {"conicoid": 1, "quadrics": _quadrics(quadrics), **views, "output": output_document(output)}


def _json(document: dict[str, Any]) -> bytes:
    return orjson.dumps(document, option=orjson.OPT_APPEND_NEWLINE | orjson.OPT_SERIALIZE_NUMPY)


def _quadrics(quadrics: Quadrics) -> list[dict[str, Any]]:
    entries, done = [], 0
    for kept in quadrics.sets:
        entries += [*_one_by_one(quadrics, done, kept.start), _set(quadrics, kept)]
        done = kept.stop
    return entries + _one_by_one(quadrics, done, len(quadrics))


def _one_by_one(quadrics: Quadrics, start: int, stop: int) -> list[dict[str, Any]]:
    """An entry for each of the quadrics start ... stop - 1."""
    part = slice(start, stop)
    shapes = [SHAPES[code] for code in quadrics.shape[part].tolist()]
    parameters = map(_parameters, shapes, quadrics.radii[part].tolist())
    forms = iter(_forms(quadrics, part).tolist())
    ids = quadrics.id[part].tolist()
    entries = [
        {"shape": shape.name}
        | ({"matrix": next(forms)} if shape.name == "quadric" else radii)
        | {"transform": transform, "id": number}
        for shape, radii, transform, number in zip(
            shapes, parameters, _transforms(quadrics, part).tolist(), ids, strict=True
        )
    ]
    for i in np.flatnonzero(np.isfinite(quadrics.z_range[part, 0])).tolist():
        entries[i]["z_range"] = quadrics.z_range[start + i].tolist()
    for i in np.flatnonzero(quadrics.capped[part]).tolist():
        entries[i]["capped"] = True
    for i in np.flatnonzero(np.diff(quadrics.clip_start[start : stop + 1])).tolist():
        entries[i]["clip"] = _clips(quadrics, start + i).tolist()
    for i, entry in enumerate(entries if quadrics.name else (), start):
        if i in quadrics.name:
            entry["name"] = quadrics.name[i]
    return entries


def _set(quadrics: Quadrics, kept: KeptSet) -> dict[str, Any]:
    """One entry for all the quadrics of a set, which have one shape."""
    part = slice(kept.start, kept.stop)
    shape = SHAPES[quadrics.shape[kept.start]]
    entry: dict[str, Any] = {"shape": shape.name, "count": kept.stop - kept.start}
    if shape.name == "quadric":
        entry["matrix"] = _forms(quadrics, part)
    elif shape.radii == 1:
        entry["radius"] = np.ascontiguousarray(quadrics.radii[part, _axis_of_radius(shape)])
    elif shape.radii:
        entry["radii"] = np.ascontiguousarray(quadrics.radii[part, : shape.radii])
    entry |= {"transform": _transforms(quadrics, part), "id": quadrics.id[part]}
    if np.isfinite(quadrics.z_range[kept.start, 0]):
        entry["z_range"] = quadrics.z_range[part]
    if quadrics.capped[part].any():
        entry["capped"] = quadrics.capped[part]
    clips = np.diff(quadrics.clip_start[kept.start : kept.stop + 1])
    if (clips == clips[0]).all() and clips[0]:
        entry["clip"] = quadrics.clip[quadrics.clip_start[kept.start] :][: clips.sum()].reshape(-1, clips[0], 4)
    elif clips.any():
        entry["clip"] = [_clips(quadrics, i) for i in range(kept.start, kept.stop)]
    if kept.name is not None:
        entry["name"] = kept.name
    return entry


def _forms(quadrics: Quadrics, part: slice) -> Floats:
    """(m, 4, 4) matrices of the quadrics that have one, in their order."""
    rows = quadrics.matrix_row[part]
    return quadrics.matrix[rows[rows >= 0]]


def _transforms(quadrics: Quadrics, part: slice) -> Floats:
    """(n, 4, 4) world_from_object with its last row."""
    upper = quadrics.world_from_object[part]
    last_row = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(upper), 1, 4))
    return np.concatenate([upper, last_row], axis=1)


def _clips(quadrics: Quadrics, i: int) -> Floats:
    """(k, 4) half-spaces of one quadric."""
    return quadrics.clip[quadrics.clip_start[i] : quadrics.clip_start[i + 1]]


def _parameters(shape: Shape, radii: list[float]) -> dict[str, Any]:
    if shape.radii == 0:
        return {}
    return {"radius": radii[_axis_of_radius(shape)]} if shape.radii == 1 else {"radii": radii[: shape.radii]}


def _axis_of_radius(shape: Shape) -> int:
    """The axis of a shape's only radius: a parabolic_cylinder's is a, a parallel_planes' c, a sphere's are alike."""
    return shape.squares.index(1)


def camera_document(camera: Camera) -> dict[str, Any]:
    """The `camera` member of the canonical document."""
    document = {
        "projection": camera.projection,
        "convention": "opengl",
        "width": camera.width,
        "height": camera.height,
        "fx": camera.fx,
        "fy": camera.fy,
        "cx": camera.cx,
        "cy": camera.cy,
        "world_from_camera": camera.world_from_camera.tolist(),
        "near": camera.near,
        "crop": list(camera.crop),
    }
    return document if np.isinf(camera.far) else document | {"far": camera.far}


def output_document(output: Output) -> dict[str, Any]:
    """The `output` member of the canonical document."""
    depth = "inf" if np.isinf(output.background_depth) else output.background_depth
    return asdict(output) | {"channels": list(output.channels), "background_depth": depth}


def scene_hash(scene: Scene) -> str:
    """SHA-256 in hexadecimal of everything in a scene that can change its image or its file; names cannot.

    It is `view_hash` of the quadrics' hash. No number in either is -0: a parsed document's never is. Scenes with equal
    canonical bytes, names apart, have equal hashes, and so have a set and its quadrics written out.
    """
    return view_hash(quadrics_hash(scene.quadrics), scene.camera, scene.output)


def quadrics_hash(quadrics: Quadrics) -> str:
    """SHA-256 in hexadecimal of these bytes, one after the other, numbers in little-endian order.

    1. the line `conicoid quadrics 1`, then the line `n m k`: quadrics, matrices, clip planes;
    2. the quadrics' arrays, as `conicoid.scene.Quadrics` describes them: shape (uint8), radii, matrix,
       world_from_object, z_range, clip (all float64), clip_start (int32), id (uint32), capped (uint8).
    """
    sizes = f"{len(quadrics)} {len(quadrics.matrix)} {len(quadrics.clip)}"
    digest = hashlib.sha256(f"conicoid quadrics 1\n{sizes}\n".encode())
    for array, dtype in (
        (quadrics.shape, "u1"),
        (quadrics.radii, "<f8"),
        (_forms(quadrics, slice(None)), "<f8"),
        (quadrics.world_from_object, "<f8"),
        (quadrics.z_range, "<f8"),
        (quadrics.clip, "<f8"),
        (quadrics.clip_start, "<i4"),
        (quadrics.id, "<u4"),
        (quadrics.capped, "u1"),
    ):
        digest.update(np.ascontiguousarray(array, dtype).data)
    return digest.hexdigest()


def view_hash(quadrics: str, camera: Camera, output: Output) -> str:
    """SHA-256 in hexadecimal of these bytes, one after the other, numbers in little-endian order.

    1. the line `conicoid scene 1`, then the line of `quadrics`, which is their `quadrics_hash`;
    2. the camera in float64: width, height, fx, fy, cx, cy, world_from_camera, near, far, crop;
    3. background_depth in float64;
    4. one line each: projection, channels with commas between, normal_space, normal_side, precision, compression,
       data_window, half_normals as True or False.
    """
    digest = hashlib.sha256(f"conicoid scene 1\n{quadrics}\n".encode())
    for numbers in (_camera_numbers(camera), np.array(output.background_depth)):
        digest.update(np.ascontiguousarray(numbers, "<f8").data)
    words = (
        camera.projection,
        ",".join(output.channels),
        output.normal_space,
        output.normal_side,
        output.precision,
        output.compression,
        output.data_window,
        str(output.half_normals),
    )
    digest.update("".join(f"{word}\n" for word in words).encode())
    return digest.hexdigest()


def _camera_numbers(camera: Camera) -> Floats:
    lens = (camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy)
    return np.array([*lens, *camera.world_from_camera.ravel(), camera.near, camera.far, *camera.crop], np.float64)
