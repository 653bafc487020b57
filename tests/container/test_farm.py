"""A farm of containers: the API and a worker beside a real RabbitMQ, PostgreSQL and S3 server."""

import json
import time
from collections.abc import Callable, Iterator

import httpx
import pytest

from tests.container import podman
from tests.farm.processes import server_port
from tests.farm.servers import Servers


@pytest.fixture(scope="module")
def options() -> Iterator[list[str]]:
    """What makes a container part of a farm of its own, on this machine's loopback."""
    with Servers() as servers:
        settings = [f"--env={name}={value}" for name, value in servers.environment().items()]
        yield ["--network=host", *settings]


def answers(url: str) -> bool:
    try:
        return httpx.get(url).status_code == 200
    except httpx.TransportError:
        return False


def wait(condition: Callable[[], bool]) -> None:
    give_up = time.monotonic() + 120  # a slow machine compiles its kernels first
    while not condition():
        assert time.monotonic() < give_up
        time.sleep(0.2)


def test_farm_of_containers_renders_the_checkouts_bytes(
    images: dict[str, str], options: list[str], scene: bytes, checkout_exr: bytes
) -> None:
    port, probes = server_port(), server_port()
    address = f"http://127.0.0.1:{port}"
    serve = ("serve", "--port", str(port))
    watched = [*options, f"--env=CONICOID_WORKER_PORT={probes}"]
    with (
        podman.started(*serve, image=images["api"], options=options),
        podman.started(image=images["worker"], options=watched) as worker,
    ):
        wait(lambda: answers(f"{address}/readyz") and answers(f"http://127.0.0.1:{probes}/readyz"))
        assert podman.healthy(worker)
        job = httpx.post(f"{address}/v1/jobs", content=scene, headers={"Content-Type": "application/json"})
        assert job.status_code == 202, job.text
        location = address + job.headers["Location"]
        wait(lambda: json.loads(httpx.get(location).content)["state"] in {"succeeded", "failed"})
        frame = httpx.get(f"{location}/frames/0", timeout=60)
        assert frame.status_code == 200, frame.text
        assert frame.content == checkout_exr
        assert podman.stop(worker, grace_s=60) == 0
