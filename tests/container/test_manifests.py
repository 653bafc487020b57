"""compose.yaml and the Kubernetes manifests: what they say agrees with the images, the settings and each other."""

import re
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import pytest
import yaml

from conicoid import __version__
from conicoid_service.farm.queues import QUEUES
from conicoid_service.server import GRACE_S
from conicoid_service.settings import Settings, variable
from tests.checkout import ROOT

FOLDER = ROOT / "docker" / "kubernetes"
OURS = ("api", "worker")
VARIABLES = {variable(field.name) for field in fields(Settings)}
# Those that `conicoid_service` leaves to the library of object stores.
AWS = {"AWS_ENDPOINT_URL", "AWS_ALLOW_HTTP", "AWS_REGION", "AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}
# A unit that fails is tried once more in a fresh process; then its image is stored.
UNIT_S = 2 * Settings().deadline_s
DOCKERFILE = (ROOT / "docker" / "Dockerfile").read_text("utf-8")
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker" / "compose.yaml").read_text("utf-8"))
SERVICES: dict[str, Any] = COMPOSE["services"]
KUSTOMIZATION: dict[str, Any] = yaml.safe_load((FOLDER / "kustomization.yaml").read_text("utf-8"))
MANIFESTS: dict[tuple[str, str], Any] = {
    (manifest["kind"], manifest["metadata"]["name"]): manifest
    for file in KUSTOMIZATION["resources"]
    for manifest in yaml.safe_load_all((FOLDER / file).read_text("utf-8"))
}


def deployment(target: str) -> dict[str, Any]:
    found: dict[str, Any] = MANIFESTS["Deployment", f"conicoid-{target}"]
    return found


def pod(target: str) -> dict[str, Any]:
    found: dict[str, Any] = deployment(target)["spec"]["template"]["spec"]
    return found


def stage(target: str) -> str:
    """The lines of a target in the Dockerfile."""
    found = re.search(rf"^FROM \S+ AS {target}\n(.*?)(?=^FROM|\Z)", DOCKERFILE, re.MULTILINE | re.DOTALL)
    assert found is not None, target
    return found[1]


def port(target: str) -> int:
    """The one port that a target's image exposes."""
    (number,) = re.findall(r"^EXPOSE (\d+)$", stage(target), re.MULTILINE)
    return int(number)


@pytest.mark.parametrize("name", OURS)
def test_images_are_targets_of_the_dockerfile_in_this_version(name: str) -> None:
    build = SERVICES[name]["build"]
    stage(build["target"])
    assert build["target"] == name
    assert build["args"]["VERSION"] == __version__
    assert SERVICES[name]["image"] == f"conicoid-{name}:{__version__}"
    (container,) = pod(name)["containers"]
    assert container["image"] == f"conicoid-{name}"
    assert {"name": container["image"], "newTag": __version__} in KUSTOMIZATION["images"]


def variables() -> Iterator[str]:
    for name in OURS:
        yield from SERVICES[name]["environment"]
        yield from (entry["name"] for entry in pod(name)["containers"][0].get("env", []))
    for generator in KUSTOMIZATION["configMapGenerator"]:
        yield from (literal.partition("=")[0] for literal in generator["literals"])
    yield from re.findall(r"CONICOID_\w+(?==)", DOCKERFILE)


def test_variables_are_settings() -> None:
    assert set(variables()) <= VARIABLES | AWS


def test_what_the_environment_file_holds_is_what_compose_asks_for() -> None:
    text = (ROOT / "docker" / "compose.yaml").read_text("utf-8")
    example = (ROOT / "docker" / "compose.env.example").read_text("utf-8")
    assert set(re.findall(r"\$\{(\w+)", text)) == set(re.findall(r"^(\w+)=$", example, re.MULTILINE))


@pytest.mark.parametrize("name", OURS)
def test_settings_of_compose_make_a_farm(name: str) -> None:
    environment = {key: re.sub(r"\$\{\w+:\?\}", "secret", text) for key, text in SERVICES[name]["environment"].items()}
    environment.pop("CONICOID_API_KEYS", None)
    assert Settings.from_environment(environment).farm


@pytest.mark.parametrize("name", OURS)
def test_probes_ask_the_port_that_the_image_exposes(name: str) -> None:
    (container,) = pod(name)["containers"]
    (exposed,) = container["ports"]
    assert exposed["containerPort"] == port(name)
    paths = {
        probe: container[probe]["httpGet"]["path"] for probe in ("startupProbe", "readinessProbe", "livenessProbe")
    }
    assert paths == {"startupProbe": "/readyz", "readinessProbe": "/readyz", "livenessProbe": "/livez"}
    assert {container[probe]["httpGet"]["port"] for probe in paths} == {exposed["name"]}
    assert container["startupProbe"]["periodSeconds"] * container["startupProbe"]["failureThreshold"] >= 120


def test_workers_listen_where_they_are_probed() -> None:
    (entry,) = pod("worker")["containers"][0]["env"]
    assert entry == {"name": "CONICOID_WORKER_PORT", "value": str(port("worker"))}
    assert f"CONICOID_WORKER_PORT={port('worker')}\n" in stage("worker")


def test_nothing_is_killed_that_ends_in_order() -> None:
    api, worker = pod("api"), pod("worker")
    pause = api["containers"][0]["lifecycle"]["preStop"]["sleep"]["seconds"]
    assert api["terminationGracePeriodSeconds"] > pause + GRACE_S
    assert worker["terminationGracePeriodSeconds"] > UNIT_S
    assert int(SERVICES["api"]["stop_grace_period"].removesuffix("s")) > GRACE_S
    assert int(SERVICES["worker"]["stop_grace_period"].removesuffix("s")) > UNIT_S


def test_workers_are_scaled_by_the_queues_of_this_version() -> None:
    scaled = MANIFESTS["ScaledObject", "conicoid-worker"]["spec"]
    assert ("Deployment", scaled["scaleTargetRef"]["name"]) in MANIFESTS
    assert {trigger["metadata"]["queueName"] for trigger in scaled["triggers"]} == {
        queue.name for queue in QUEUES.values()
    }
    for trigger in scaled["triggers"]:
        assert ("TriggerAuthentication", trigger["authenticationRef"]["name"]) in MANIFESTS
    assert "replicas" not in deployment("worker")["spec"]  # or every `apply` would set it back


@pytest.mark.parametrize("name", OURS)
def test_containers_are_locked_down_and_bounded(name: str) -> None:
    (container,) = pod(name)["containers"]
    assert container["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    context = pod(name)["securityContext"]
    assert (context["runAsNonRoot"], context["runAsUser"]) == (True, 10001)
    assert "USER 10001:10001\n" in DOCKERFILE
    assert {"cpu", "memory"} <= container["resources"]["limits"].keys()
    service = SERVICES[name]
    assert (service["read_only"], service["cap_drop"]) == (True, ["ALL"])
    assert {"cpus", "memory", "pids"} <= service["deploy"]["resources"]["limits"].keys()


@pytest.mark.parametrize("name", OURS)
def test_what_is_written_is_mounted(name: str) -> None:
    (container,) = pod(name)["containers"]
    mounted = {mount["mountPath"] for mount in container["volumeMounts"]}
    assert mounted == {"/tmp", *re.findall(r"^VOLUME (\S+)$", stage("runtime"), re.MULTILINE)}
    assert {mount["name"] for mount in container["volumeMounts"]} == {volume["name"] for volume in pod(name)["volumes"]}


def test_services_wait_for_servers_that_say_when_they_are_healthy() -> None:
    servers = SERVICES.keys() - set(OURS)
    for name in OURS:
        waits = {server: how["condition"] for server, how in SERVICES[name]["depends_on"].items()}
        assert waits == dict.fromkeys(servers, "service_healthy")
    for server in servers:
        assert SERVICES[server]["healthcheck"]["test"]


def test_every_volume_of_compose_is_declared() -> None:
    used = {volume.partition(":")[0] for service in SERVICES.values() for volume in service["volumes"]}
    assert used == COMPOSE["volumes"].keys()


def test_selectors_find_the_pods() -> None:
    labels = [deployment(name)["spec"]["template"]["metadata"]["labels"] for name in OURS]
    for (kind, name), manifest in MANIFESTS.items():
        spec = manifest["spec"]
        selector = {
            "Deployment": lambda spec: spec["selector"]["matchLabels"],
            "PodDisruptionBudget": lambda spec: spec["selector"]["matchLabels"],
            "NetworkPolicy": lambda spec: spec["podSelector"]["matchLabels"],
            "Service": lambda spec: spec["selector"],
        }.get(kind)
        if selector is not None:
            assert selector(spec) in labels, (kind, name)


def test_manifests_name_no_namespace_and_hold_no_secret() -> None:
    assert all("namespace" not in manifest["metadata"] for manifest in MANIFESTS.values())
    assert "Secret" not in {kind for kind, _ in MANIFESTS}
    text = "".join(path.read_text("utf-8") for path in FOLDER.iterdir())
    assert not re.search(r"\b(amqps?|postgresql)://", text)
