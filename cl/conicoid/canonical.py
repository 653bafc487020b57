"""The canonical form of a scene: the document that says all of it, and the hash of its exact numbers."""

import hashlib
from dataclasses import asdict
from typing import Any

import numpy as np
import orjson

from conicoid.collector import paused_collector
from conicoid.scene import Camera, Floats, Output, Quadrics, Scene
from conicoid.shapes import SHAPES, Shape


def canonical_document(scene: Scene) -> dict[str, Any]:
    """The scene as a document with every number derived and every default filled in; its own canonical form.

    Keys come in a fixed order. Keys whose absence has a meaning of its own (`z_range`, `capped`, `clip`, `name`, `far`)
    are there only where they say something.
    """
    with paused_collector():
        return {
            "conicoid": 1,
            "quadrics": _quadrics(scene.quadrics),
            "camera": camera_document(scene.camera),
            "output": _output(scene.output),
        }


def canonical_bytes(scene: Scene) -> bytes:
    """The canonical document as compact UTF-8 JSON with shortest round-trip floats and a newline at the end."""
    return orjson.dumps(canonical_document(scene), option=orjson.OPT_APPEND_NEWLINE)


def _quadrics(quadrics: Quadrics) -> list[dict[str, Any]]:
    last_row = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(quadrics), 1, 4))
    transforms = np.concatenate([quadrics.world_from_object, last_row], axis=1).tolist()
    shapes = [SHAPES[code] for code in quadrics.shape.tolist()]
    parameters = map(_parameters, shapes, quadrics.radii.tolist())
    forms = iter(_forms(quadrics).tolist())
    documents = [
        {"shape": shape.name}
        | ({"matrix": next(forms)} if shape.name == "quadric" else radii)
        | {"transform": transform, "id": number}
        for shape, radii, transform, number in zip(shapes, parameters, transforms, quadrics.id.tolist(), strict=True)
    ]
    for i in np.flatnonzero(np.isfinite(quadrics.z_range[:, 0])).tolist():
        documents[i]["z_range"] = quadrics.z_range[i].tolist()
    for i in np.flatnonzero(quadrics.capped).tolist():
        documents[i]["capped"] = True
    for i in np.flatnonzero(np.diff(quadrics.clip_start)).tolist():
        documents[i]["clip"] = quadrics.clip[quadrics.clip_start[i] : quadrics.clip_start[i + 1]].tolist()
    for i, name in quadrics.name.items():
        documents[i]["name"] = name
    return documents


def _forms(quadrics: Quadrics) -> Floats:
    """(m, 4, 4) matrices of the quadrics that have one, in their order."""
    return quadrics.matrix[quadrics.matrix_row[quadrics.matrix_row >= 0]]


def _parameters(shape: Shape, radii: list[float]) -> dict[str, Any]:
    if shape.radii == 0:
        return {}
    if shape.radii == 1:
        # A sphere's radii are all alike; a parabolic_cylinder's radius is a, a parallel_planes' is c.
        return {"radius": radii[shape.squares.index(1)]}
    return {"radii": radii[: shape.radii]}


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


def _output(output: Output) -> dict[str, Any]:
    depth = "inf" if np.isinf(output.background_depth) else output.background_depth
    return asdict(output) | {"channels": list(output.channels), "background_depth": depth}


def scene_hash(scene: Scene) -> str:
    """SHA-256 in hexadecimal of everything in a scene that can change its image or its file; names cannot.

    The hash is over these bytes, one after the other, numbers in little-endian order:

    1. the line `conicoid scene 1`, then the line `n m k`: quadrics, matrices, clip planes;
    2. the quadrics' arrays, as `conicoid.scene.Quadrics` describes them: shape (uint8), radii, matrix,
       world_from_object, z_range, clip (all float64), clip_start (int32), id (uint32), capped (uint8);
    3. the camera in float64: width, height, fx, fy, cx, cy, world_from_camera, near, far, crop;
    4. background_depth in float64;
    5. one line each: projection, channels with commas between, normal_space, normal_side, precision, compression,
       data_window, half_normals as True or False.

    No number is -0: a parsed document's never is. Scenes with equal canonical bytes, names apart, have equal hashes.
    """
    quadrics, camera, output = scene.quadrics, scene.camera, scene.output
    sizes = f"{len(quadrics)} {len(quadrics.matrix)} {len(quadrics.clip)}"
    digest = hashlib.sha256(f"conicoid scene 1\n{sizes}\n".encode())
    for array, dtype in (
        (quadrics.shape, "u1"),
        (quadrics.radii, "<f8"),
        (_forms(quadrics), "<f8"),
        (quadrics.world_from_object, "<f8"),
        (quadrics.z_range, "<f8"),
        (quadrics.clip, "<f8"),
        (quadrics.clip_start, "<i4"),
        (quadrics.id, "<u4"),
        (quadrics.capped, "u1"),
        (_camera_numbers(camera), "<f8"),
        (np.array(output.background_depth), "<f8"),
    ):
        digest.update(np.ascontiguousarray(array, dtype).data)
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
