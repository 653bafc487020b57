"""The container image: Debian 13 and its own PoCL, unprivileged, without network or a writable root."""

from tests.container import podman


def test_container_renders_the_checkouts_bytes(image: str, scene: bytes, checkout_exr: bytes) -> None:
    assert podman.run("render", "-", "-o", "-", image=image, stdin=scene) == checkout_exr


def test_container_runs_as_a_fixed_unprivileged_user(image: str) -> None:
    assert podman.run("-u", image=image, entrypoint="id") == b"10001\n"


def test_image_keeps_nothing_of_the_machine_that_built_it(image: str) -> None:
    find = ["/run/secrets", "/etc/pip.conf", "/src", "/wheel", "/root/.cache", "/var/lib/apt/lists/lock"]
    listing = podman.run("-c", f"ls -d {' '.join(find)} 2>/dev/null || true", image=image, entrypoint="sh")
    assert listing == b""
