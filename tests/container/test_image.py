"""The container image: Debian 13 and its own PoCL, unprivileged, without network or a writable root."""

import time

from tests.container import podman

READY = "from urllib.request import urlopen; urlopen('http://127.0.0.1:8000/readyz')"
KILLED = 128 + 9


def test_container_renders_the_checkouts_bytes(image: str, scene: bytes, checkout_exr: bytes) -> None:
    assert podman.run("render", "-", "-o", "-", image=image, stdin=scene) == checkout_exr


def test_container_serves_by_default_and_stops_when_told(image: str) -> None:
    with podman.started(image) as container:
        give_up = time.monotonic() + 120  # a slow machine compiles its kernels first
        while podman.execute(container, "python", "-c", READY).returncode:
            assert time.monotonic() < give_up
            time.sleep(1)
        assert podman.stop(container, grace_s=60) != KILLED


def test_container_runs_as_a_fixed_unprivileged_user(image: str) -> None:
    assert podman.run("-u", image=image, entrypoint="id") == b"10001\n"


def test_image_keeps_nothing_of_the_machine_that_built_it(image: str) -> None:
    find = ["/run/secrets", "/etc/pip.conf", "/src", "/wheel", "/root/.cache", "/var/lib/apt/lists/lock"]
    listing = podman.run("-c", f"ls -d {' '.join(find)} 2>/dev/null || true", image=image, entrypoint="sh")
    assert listing == b""
