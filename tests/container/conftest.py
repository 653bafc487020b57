"""What is shipped, made once for all tests here: the wheel, the images, and lysozyme as the checkout renders it."""

import subprocess
from ast import literal_eval
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.checkout import BIN, ROOT
from tests.container import podman

# The default one, which a build without `--target` makes, comes last.
TARGETS = ("worker", "api", "all-in-one")
REVISION = "0123456789abcdef"


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built wheel; hatchling comes from the lock."""
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run([BIN / "pip", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", folder, ROOT], check=True)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="session")
def scene() -> bytes:
    """Lysozyme's scene document."""
    return (ROOT / "examples" / "lysozyme.json").read_bytes()


@pytest.fixture(scope="session")
def checkout_exr(scene: bytes, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Lysozyme as the checkout's own command renders it."""
    path = tmp_path_factory.mktemp("checkout") / "lysozyme.exr"
    subprocess.run([BIN / "conicoid", "render", "-", "-o", path], input=scene, check=True)
    return path.read_bytes()


def pip_settings() -> Iterator[tuple[str, str]]:
    """This machine's own package index, proxy and certificate, the environment's after the files'."""
    lines = subprocess.run([BIN / "pip", "config", "list"], stdout=subprocess.PIPE, text=True, check=True).stdout
    for line in sorted(lines.splitlines(), key=lambda line: line.startswith(":env:")):
        name, value = line.split("=", 1)
        yield name.rpartition(".")[2], literal_eval(value)


@pytest.fixture(scope="session")
def images(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The images of `docker/Dockerfile` by target, built from this checkout."""
    scratch = tmp_path_factory.mktemp("image")
    settings = {name: value for name, value in pip_settings() if name in {"cert", "index-url", "proxy", "timeout"}}
    secrets = {"pip.conf": scratch / "pip.conf"}
    if "cert" in settings:
        secrets["ca.crt"] = Path(settings["cert"])
        settings["cert"] = "/run/secrets/ca.crt"
    secrets["pip.conf"].write_text("\n".join(["[global]", *(f"{name} = {value}" for name, value in settings.items())]))
    podman.ensure_base(scratch)
    tags = {target: f"conicoid-test-{target}" for target in TARGETS}
    for target, tag in tags.items():
        podman.build(ROOT, target, tag, secrets, {"VERSION": version("conicoid"), "REVISION": REVISION})
    podman.prune()
    return tags


@pytest.fixture(scope="session")
def image(images: dict[str, str]) -> str:
    """The default image."""
    return images["all-in-one"]
