"""The examples are what their scripts write, show what they promise, and are accepted."""

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

from conicoid_client import Client
from conicoid_client.exr import decode
from tests.checkout import ROOT

EXAMPLES = ROOT / "examples"
NAMES = ["far", "lysozyme", "orthographic", "shapes"]
BATCHES = ["turntable"]


def document(name: str) -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads((EXAMPLES / f"{name}.json").read_bytes())
    return loaded


def test_every_example_is_tested() -> None:
    assert sorted(path.stem for path in EXAMPLES.glob("*.json")) == NAMES + BATCHES


@pytest.mark.parametrize("name", NAMES + BATCHES)
def test_a_script_writes_its_scene_byte_for_byte(name: str, tmp_path: Path) -> None:
    for path in EXAMPLES.glob(f"{name}.[!j]*"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    runpy.run_path(str(tmp_path / f"{name}.py"), run_name="__main__")
    assert (tmp_path / f"{name}.json").read_bytes() == (EXAMPLES / f"{name}.json").read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_an_example_renders_and_is_seen(name: str, address: str) -> None:
    scene = document(name)
    scene["camera"] |= {side: scene["camera"][side] // 10 for side in ("width", "height")}
    with Client(address) as client:
        hits = decode(client.render(scene).exr).hits()
    assert hits is not None
    assert 0.1 < hits.mean() < 0.9


def test_turntable_is_seen_from_every_side(address: str) -> None:
    scene = document("turntable")
    views = scene.pop("cameras")
    with Client(address) as client:
        masks = [decode(client.render({**scene, "camera": view}).exr).hits() for view in views]
    assert len({mask.tobytes() for mask in masks if mask is not None}) == len(views) == 24
    assert all(mask is not None and 0.05 < mask.mean() < 0.9 for mask in masks)


def test_lysozyme_is_all_atoms_and_bonds() -> None:
    shapes = [quadric["shape"] for quadric in document("lysozyme")["quadrics"]]
    assert (shapes.count("sphere"), shapes.count("cylinder")) == (1960, 1980)


def test_shapes_shows_every_shape_of_the_schema_and_each_is_visible(address: str) -> None:
    scene = document("shapes")
    names = [quadric["shape"] for quadric in scene["quadrics"]]
    with Client(address) as client:
        ids = decode(client.render(scene).exr).channels["id"]
    assert len(set(names)) == len(names) == 14
    assert {names[k - 1] for k in set(ids.ravel().tolist()) - {0}} == set(names)


def test_far_is_far() -> None:
    scene = document("far")
    centres = [x for quadric in scene["quadrics"] for x in quadric["center"]]
    assert min(map(abs, centres)) > 0.99e7
    assert document("orthographic")["camera"]["projection"] == "orthographic"
