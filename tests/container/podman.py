"""Podman with a store of its own: Debian's package, no daemon, no image registry, no kernel features beyond chroot."""

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

AS_ROOT = [] if os.geteuid() == 0 else ["sudo"]
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "conicoid"
BASE = "debian:trixie-slim"

# runc, because Debian 12's crun refuses hybrid cgroups; cgroupfs and a file of events, because there may be no systemd.
PODMAN = [
    *AS_ROOT, "podman", f"--root={CACHE / 'podman'}", "--runroot=/run/conicoid-podman",
    "--runtime=runc", "--cgroup-manager=cgroupfs", "--events-backend=file",
]  # fmt: skip

# What a careful farm would set; the limits are explicit because podman's own are above what a CI machine may grant.
LOCKED_DOWN = [
    "--network=none", "--read-only", "--cap-drop=all", "--security-opt=no-new-privileges",
    "--ulimit=nofile=1024:1024", "--ulimit=nproc=4096:4096",
]  # fmt: skip


def build(context: Path, tag: str, secrets: dict[str, Path]) -> None:
    """Build the image of `docker/Dockerfile`; each secret is a file for the build that stays out of the image."""
    given = [f"--secret=id={name},src={path}" for name, path in secrets.items()]
    how = ["--pull=never", "--isolation=chroot", "--format=docker", *given]
    subprocess.run([*PODMAN, "build", *how, "--file=docker/Dockerfile", f"--tag={tag}", "."], cwd=context, check=True)
    subprocess.run([*PODMAN, "image", "prune", "--force"], check=True)  # earlier builds, or the store grows for ever


def run(*arguments: str, image: str, stdin: bytes = b"", entrypoint: str | None = None) -> bytes:
    """Standard output of the image run locked down, without network; its errors go to standard error."""
    start = [] if entrypoint is None else [f"--entrypoint={entrypoint}"]
    command = [*PODMAN, "run", "--rm", "--interactive", *LOCKED_DOWN, *start, image, *arguments]
    return subprocess.run(command, input=stdin, stdout=subprocess.PIPE, check=True).stdout


@contextmanager
def started(image: str) -> Iterator[str]:
    """The id of a container that runs the image's own command; it is removed in the end, however that comes."""
    command = [*PODMAN, "run", "--detach", *LOCKED_DOWN, image]
    container = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    try:
        yield container
    finally:
        subprocess.run([*PODMAN, "rm", "--force", "--volumes", container], stdout=subprocess.DEVNULL, check=True)


def execute(container: str, *command: str) -> subprocess.CompletedProcess[bytes]:
    """A command inside a started container, whatever its exit status."""
    return subprocess.run([*PODMAN, "exec", container, *command], stdout=subprocess.PIPE, check=False)


def stop(container: str, grace_s: int) -> int:
    """Exit status of the container after SIGTERM; 137 where it had to be killed after `grace_s` seconds."""
    subprocess.run([*PODMAN, "stop", f"--time={grace_s}", container], stdout=subprocess.DEVNULL, check=True)
    inspect = [*PODMAN, "inspect", "--format={{.State.ExitCode}}", container]
    return int(subprocess.run(inspect, stdout=subprocess.PIPE, check=True).stdout)


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
