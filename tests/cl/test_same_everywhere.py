"""`exact` gives the same bytes on every device and platform, whatever the vector width, the tiles and the threads."""

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from conicoid.device import DeviceInfo, list_devices
from tests.checkout import ROOT

Digests = dict[str, dict[str, str]]

# What every other run is compared with is PoCL's.
DEVICES = sorted((device for device in list_devices() if device.float64), key=lambda device: device.pocl is None)


def takes_512_bits(device: DeviceInfo) -> bool:
    # PoCL 3.0 aborts on them on some machines (`DeviceInfo.double_lanes`).
    return device.pocl is None or device.pocl >= (3, 1)


VARIANTS = [
    (device, lanes, threads, tile)
    for device in DEVICES
    for lanes, threads, tile in ((4, 1, 16), (4, 2, 16), (8, 2, 16), (4, 2, 8), (4, 2, 32))
    if lanes == 4 or takes_512_bits(device)
]


@cache
def digests(device: str, lanes: int, threads: int, tile: int, folder: Path) -> Digests:
    """From a process of its own, with a kernel cache of its own."""
    arguments = ["--lanes", str(lanes), *(() if tile == 16 else ("--tile", str(tile)))]
    environment = {
        **os.environ,
        "CONICOID_DEVICE": device,
        "POCL_CACHE_DIR": str(folder / f"{lanes}-{threads}-{tile}-{abs(hash(device))}"),
        "POCL_MAX_PTHREAD_COUNT": str(threads),
    }
    Path(environment["POCL_CACHE_DIR"]).mkdir()
    done = subprocess.run(
        [sys.executable, "-m", "tests.cl.digests", *arguments],
        check=False,
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    found: Digests = json.loads(done.stdout)
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("caches")


@pytest.mark.parametrize(
    ("device", "lanes", "threads", "tile"),
    VARIANTS[1:],
    ids=[
        f"{device.pocl or device.platform}-{lanes} lanes-{threads} threads-tile {tile}"
        for device, lanes, threads, tile in VARIANTS[1:]
    ],
)
def test_the_bytes_are_the_same(device: DeviceInfo, lanes: int, threads: int, tile: int, folder: Path) -> None:
    first_device, *first = VARIANTS[0]
    expected = digests(first_device.version, *first, folder)
    got = digests(device.version, lanes, threads, tile, folder)
    assert len(got) >= 20
    different = [
        f"{name}: {part}" for name in expected for part in expected[name] if got[name][part] != expected[name][part]
    ]
    assert not different
