"""`conicoid bench speed`: laps in turn, growth, and all of it from end to end on tiny images."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from conicoid.scene import Scene
from conicoid_bench.picture import Picture
from conicoid_bench.scenes import BenchScene
from conicoid_bench.speed.growth import Sweep, per_doubling, sweeps
from conicoid_bench.speed.race import RIGHT, pixels_only, race
from conicoid_bench.speed.run import Effort, Speed
from conicoid_bench.speed.scenes import built_in
from conicoid_bench.speed.table import driver, fastest_right, markdown
from conicoid_bench.workloads import camera, ellipsoids, spheres
from tests.checkout import ROOT
from tests.clients.command import conicoid

TINY = camera(48, 27)
EXACT = Picture(np.ones((50, 200), np.float32), np.ones((50, 200), np.uint32), np.ones((50, 200, 3), np.float32))


class Fake:
    """Laps that take what they say, and a picture with some wrong pixels."""

    def __init__(self, name: str, laps: list[tuple[float, float]], wrong: int = 0, raced: bool = True) -> None:
        self.name, self.raced, self.taken = name, raced, 0
        self._laps, self._wrong = laps, wrong

    def why_not(self, scene: Scene) -> str | None:
        return "has too many quadrics" if len(scene.quadrics) > 99 else None

    @contextmanager
    def enter(self, _: Scene) -> Iterator["Fake"]:
        yield self

    def lap(self) -> tuple[float, float]:
        self.taken += 1
        return self._laps[self.taken % len(self._laps)]

    def picture(self) -> Picture:
        seen = EXACT.id.copy()
        seen.ravel()[: self._wrong] = 2
        return replace(EXACT, id=seen)


def test_medians_are_of_build_of_cast_and_of_their_sum() -> None:
    peer = Fake("peer", [(1, 10), (5, 1), (2, 20)])
    floor, rows = race([peer], lambda: 0.5, ellipsoids(3, 1.0), EXACT, pixels_only, laps=3, enough_s=9)
    assert (floor, rows["peer"]["build_ms"], rows["peer"]["cast_ms"], rows["peer"]["ms"]) == (0.5, 2, 10, 11)
    # One lap warms.
    assert (rows["peer"]["laps"], peer.taken) == (3, 4)


def test_who_is_slow_takes_three_laps_while_others_take_all() -> None:
    slow, quick = Fake("slow", [(500, 600)]), Fake("quick", [(1, 1)])
    _, rows = race([slow, quick], lambda: 1, ellipsoids(3, 1.0), EXACT, pixels_only, laps=7, enough_s=2)
    assert (rows["slow"]["laps"], rows["quick"]["laps"]) == (3, 7)


def test_only_right_pictures_that_are_raced_count() -> None:
    most = int(RIGHT * EXACT.id.size)
    peers = [Fake("right", [(1, 1)], most), Fake("wrong", [(1, 0)], most + 1), Fake("checked", [(0, 0)], raced=False)]
    _, rows = race(peers, lambda: 1, ellipsoids(3, 1.0), EXACT, pixels_only, laps=3, enough_s=1)
    assert [rows[name]["right"] for name in ("right", "wrong", "checked")] == [True, False, False]
    assert rows["wrong"]["wrong_ids"] == most + 1
    assert "ms" not in rows["checked"]
    assert fastest_right({"contenders": rows}) == "right"
    assert fastest_right({"contenders": {"Conicoid exact": {"right": True, "ms": 1}}}) is None


def test_who_cannot_take_part_is_told_why() -> None:
    _, rows = race([Fake("peer", [(1, 1)])], lambda: 1, ellipsoids(100, 1.0), EXACT, pixels_only, laps=3, enough_s=1)
    assert rows == {"peer": {"not_measured": "has too many quadrics"}}


@pytest.mark.parametrize(("power", "factor"), [(0, 1), (1, 2), (2, 4)])
def test_a_power_of_the_value_grows_by_that_of_two(power: int, factor: float) -> None:
    values = [1, 2, 10, 1000]
    assert per_doubling(values, [3.0 * value**power for value in values]) == pytest.approx([factor] * 3)


def test_sweeps_vary_what_they_say() -> None:
    quadrics, pixels, coverage, overlap = sweeps(quick=True)
    assert [len(quadrics.scene(value).quadrics) for value in quadrics.values] == [1, 10, 100, 1000, 10_000, 100_000]
    assert [quadrics.label(value) for value in quadrics.values[:2]] == ["10⁰", "10¹"]
    assert pixels.label(pixels.values[0]) == "64²"
    for value in pixels.values:
        assert pixels.scene(value).camera.width * pixels.scene(value).camera.height == value
    assert [coverage.label(value) for value in coverage.values] == ["1%", "4%", "16%", "64%"]
    assert [len(overlap.scene(value).quadrics) for value in overlap.values] == [100, 400, 1600, 6400]
    assert next(iter(sweeps(most_quadrics=10**7))).values[-1] == 10**7
    assert len(list(built_in())) == len(list(built_in(quick=True))) + 1 == 8


def test_results_are_json_and_tables_of_all_who_took_part() -> None:
    scenes = [BenchScene("two", "a reason", replace(spheres(2, 0.5), camera=TINY))]
    grows = Sweep("quadrics", "how many", [1, 4], lambda n: replace(ellipsoids(int(n), 1.0), camera=TINY), str)
    said: list[str] = []
    speed = Speed(None, Path("absent"), Effort(laps=3, enough_s=0.1, checked=50), said.append)
    results = json.loads(json.dumps(speed.run(scenes, [grows])))
    assert said[0] == "two"
    assert results["missing"]["Embree"] == "absent is not there; `make embree` builds it, with Debian's libembree-dev"
    (scene,) = results["scenes"]
    assert scene["verified"]["pixels"] == 50
    assert scene["write_only_ms"] > 0
    for name in ("Conicoid exact", "Conicoid float64", "NumPy float64"):
        row = scene["contenders"][name]
        assert row["right"]
        assert row["laps"] == 3
        assert (row["wrong_hits"], row["wrong_ids"]) == (0, 0)
    (growth,) = results["growth"]
    assert [point["at"] for point in growth["points"]] == [1, 4]
    assert len(growth["per_doubling"]["Conicoid exact"]) == 1
    text = markdown(results)
    assert text.startswith(f"**{driver(results)}**, ")
    assert len([line for line in text.splitlines() if line.startswith("| two |")]) == 2
    assert "Embree took no part: absent is not there" in text


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["absent.json"], 1, "absent.json: no such file"),
        (["--most-quadrics", "0"], 2, "is not a whole number"),
        (["-o", "absent/out"], 1, "absent does not exist"),
    ],
)
def test_what_makes_no_sense_is_refused_first(arguments: list[str], status: int, message: str, tmp_path: Path) -> None:
    done = conicoid("bench", "speed", "-o", "out", *arguments, cwd=tmp_path)
    assert done.returncode == status
    assert message in done.stderr.decode()
    assert not (tmp_path / "out").exists()


def test_the_documented_tables_are_those_of_the_recorded_results() -> None:
    page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    records = sorted((ROOT / "bench" / "results").glob("speed-*.json"))
    assert records
    for record in records:
        assert markdown(json.loads(record.read_bytes())) in page
        assert f"growth-{record.stem.removeprefix('speed-')}.png" in page
