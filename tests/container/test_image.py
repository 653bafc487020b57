"""The container images: Debian 13 and its own PoCL, unprivileged, without network or a writable root."""

import json
import os
import re
import time
from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import Any

import pytest

from tests.checkout import ROOT
from tests.container import podman
from tests.container.conftest import REVISION, TARGETS

KILLED = 128 + 9
NO_NETWORK = "--network=none"
# Bytes of all layers on top of the base; docs/containers.md says how many there are.
SIZE_LIMIT = 850 * 10**6


@pytest.mark.parametrize("target", TARGETS)
def test_container_renders_the_checkouts_bytes(
    images: dict[str, str], target: str, scene: bytes, checkout_exr: bytes
) -> None:
    assert podman.run("render", "-", "-o", "-", image=images[target], stdin=scene) == checkout_exr


def get(container: str, path: str) -> tuple[int, bytes]:
    """Status and body of the service's answer, asked for inside the container; 0 where there is none yet."""
    code = (
        "from http.client import HTTPConnection\n"
        "connection = HTTPConnection('127.0.0.1', 8000)\n"
        f"connection.request('GET', '{path}')\n"
        "answer = connection.getresponse()\n"
        "print(answer.status)\nprint(answer.read().decode())"
    )
    status, _, body = podman.execute(container, "python", "-c", code).stdout.partition(b"\n")
    return int(status or b"0"), body


def wait(condition: Callable[[], bool]) -> None:
    give_up = time.monotonic() + 120  # a slow machine compiles its kernels first
    while not condition():
        assert time.monotonic() < give_up
        time.sleep(0.5)


@pytest.mark.parametrize("target", ["api", "all-in-one"])
def test_container_serves_is_healthy_and_stops_when_told(images: dict[str, str], target: str) -> None:
    with podman.started(image=images[target]) as container:
        wait(lambda: get(container, "/readyz")[0] == 200)
        assert podman.healthy(container)
        assert podman.stop(container, grace_s=60) == 0


def test_health_check_sees_that_nobody_answers(image: str) -> None:
    with podman.started("serve", "--port", "8001", image=image) as container:
        assert not podman.healthy(container)
        assert podman.stop(container, grace_s=60) != KILLED  # while it starts, too


def test_container_renders_with_the_cpus_of_its_quota(image: str) -> None:
    assert len(os.sched_getaffinity(0)) > 1, "a machine of one CPU cannot show it"
    with podman.started(image=image, options=[NO_NETWORK, "--cpus=1"]) as container:
        wait(lambda: get(container, "/readyz")[0] == 200)
        device: dict[str, Any] = json.loads(get(container, "/v1/device")[1])
    assert (device["threads"], device["compute_units"]) == (1, 1)


def test_memory_of_a_render_process_comes_from_the_containers_limit(image: str) -> None:
    code = "from conicoid_service.memory import usable_memory; print(usable_memory())"
    options = [NO_NETWORK, "--memory=1g", "--entrypoint=python"]
    assert podman.run("-c", code, image=image, options=options) == b"%d\n" % 2**30


@pytest.mark.parametrize("target", TARGETS)
def test_container_runs_as_a_fixed_unprivileged_user(images: dict[str, str], target: str) -> None:
    assert podman.run("-u", image=images[target], options=[NO_NETWORK, "--entrypoint=id"]) == b"10001\n"


def test_image_keeps_nothing_of_the_machine_that_built_it(image: str) -> None:
    find = ["/run/secrets", "/etc/pip.conf", "/src", "/wheel", "/root/.cache", "/var/lib/apt/lists/lock"]
    listing = f"ls -d {' '.join(find)} 2>/dev/null || true"
    assert podman.run("-c", listing, image=image, options=[NO_NETWORK, "--entrypoint=sh"]) == b""


@pytest.mark.parametrize("target", TARGETS)
def test_image_names_what_it_was_made_of_and_how_it_is_stopped(images: dict[str, str], target: str) -> None:
    config = podman.inspect(images[target])["Config"]
    labels = {name.rpartition(".")[2]: text for name, text in config["Labels"].items()}
    assert labels["revision"] == REVISION
    assert labels["version"] == version("conicoid")
    assert config["StopSignal"] == "SIGTERM"
    assert config["Entrypoint"][0] == "tini"


def layers(image: str) -> Sequence[str]:
    """Digests of an image's layers, the base's first."""
    found: list[str] = podman.inspect(image)["RootFS"]["Layers"]
    return found


def test_targets_share_all_their_layers(images: dict[str, str]) -> None:
    assert len({tuple(layers(image)) for image in images.values()}) == 1


def test_image_is_as_large_as_is_said(image: str) -> None:
    size = podman.inspect(image)["Size"] - podman.inspect(podman.BASE)["Size"]
    assert size < SIZE_LIMIT
    said = re.search(r"([\d,]+) MB on top of its base", (ROOT / "docs" / "containers.md").read_text("utf-8"))
    assert said is not None
    assert size / 10**6 == pytest.approx(int(said[1].replace(",", "")), rel=0.05)
