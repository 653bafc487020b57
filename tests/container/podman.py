"""Podman with a store of its own: Debian's package, no daemon, no image registry, no kernel features beyond chroot."""

import json
import os
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

AS_ROOT = [] if os.geteuid() == 0 else ["sudo"]
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "conicoid"
BASE = "debian:trixie-slim"

# runc, because Debian 12's crun refuses hybrid cgroups; cgroupfs and a file of events, because there may be no systemd.
PODMAN = [
    *AS_ROOT, "podman", f"--root={CACHE / 'podman'}", "--runroot=/run/conicoid-podman",
    "--runtime=runc", "--cgroup-manager=cgroupfs", "--events-backend=file",
]  # fmt: skip

# What a careful farm would set, with /tmp as Docker's --tmpfs makes it; the limits are explicit because podman's own
# are above what a CI machine may grant.
LOCKED_DOWN = [
    "--read-only", "--read-only-tmpfs=false", "--tmpfs=/tmp:rw,noexec,nosuid,nodev,mode=1777", "--cap-drop=all",
    "--security-opt=no-new-privileges", "--ulimit=nofile=1024:1024", "--ulimit=nproc=4096:4096",
]  # fmt: skip


def build(context: Path, target: str, tag: str, secrets: dict[str, Path], arguments: dict[str, str]) -> None:
    """Build a target of `docker/Dockerfile`; each secret is a file for the build that stays out of the image."""
    given = [f"--secret=id={name},src={path}" for name, path in secrets.items()]
    given += [f"--build-arg={name}={value}" for name, value in arguments.items()]
    how = ["--pull=never", "--isolation=chroot", "--format=docker", f"--target={target}", *given]
    subprocess.run([*PODMAN, "build", *how, "--file=docker/Dockerfile", f"--tag={tag}", "."], cwd=context, check=True)


def prune() -> None:
    """Drop what earlier builds have left, or the store grows for ever."""
    subprocess.run([*PODMAN, "image", "prune", "--force"], check=True)


def inspect(image: str) -> dict[str, Any]:
    """What an image says about itself."""
    command = [*PODMAN, "image", "inspect", image]
    found: list[dict[str, Any]] = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)
    return found[0]


def run(*arguments: str, image: str, stdin: bytes = b"", options: Sequence[str] = ("--network=none",)) -> bytes:
    """Standard output of the image run locked down; its errors go to standard error."""
    # Podman's own health checks need systemd.
    command = [*PODMAN, "run", "--rm", "--interactive", "--no-healthcheck", *LOCKED_DOWN, *options, image, *arguments]
    return subprocess.run(command, input=stdin, stdout=subprocess.PIPE, check=True).stdout


@contextmanager
def started(*arguments: str, image: str, options: Sequence[str] = ("--network=none",)) -> Iterator[str]:
    """The id of a container that runs in the background; its log is shown and it is removed in the end."""
    command = [*PODMAN, "run", "--detach", *LOCKED_DOWN, *options, image, *arguments]
    container = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    try:
        yield container
    finally:
        subprocess.run([*PODMAN, "logs", container], check=True)
        subprocess.run([*PODMAN, "rm", "--force", "--volumes", container], stdout=subprocess.DEVNULL, check=True)


def execute(container: str, *command: str) -> subprocess.CompletedProcess[bytes]:
    """A command inside a started container, whatever its exit status."""
    return subprocess.run([*PODMAN, "exec", container, *command], stdout=subprocess.PIPE, check=False)


def healthy(container: str) -> bool:
    """Whether the image's own health check passes now."""
    command = [*PODMAN, "healthcheck", "run", container]
    return subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode == 0


def stop(container: str, grace_s: int) -> int:
    """Exit status of the container after its signal to stop; 137 where it had to be killed after `grace_s` seconds."""
    subprocess.run([*PODMAN, "stop", f"--time={grace_s}", container], stdout=subprocess.DEVNULL, check=True)
    status = [*PODMAN, "inspect", "--format={{.State.ExitCode}}", container]
    return int(subprocess.run(status, stdout=subprocess.PIPE, check=True).stdout)


def ensure_base(scratch: Path) -> None:
    """Make Debian 13 by debootstrap under the name that the Dockerfile starts from; kept between runs."""
    if subprocess.run([*PODMAN, "image", "exists", BASE], check=False).returncode == 0:
        return
    tree, tar = str(scratch / "trixie"), str(scratch / "trixie.tar")
    subprocess.run([*AS_ROOT, "debootstrap", "--variant=minbase", "trixie", tree], check=True)
    copied_from_this_machine = ["--exclude=./etc/resolv.conf", "--exclude=./etc/hostname"]
    subprocess.run([*AS_ROOT, "tar", f"--directory={tree}", *copied_from_this_machine, "-cf", tar, "."], check=True)
    subprocess.run([*PODMAN, "import", tar, BASE], check=True)
    subprocess.run([*AS_ROOT, "rm", "-rf", tree, tar], check=True)
