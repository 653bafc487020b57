"""`conicoid device`: the OpenCL devices here, or what a running service renders with."""

import argparse
import json
import subprocess
import sys
from typing import Any

from conicoid_client import files
from conicoid_client.command.connect import connect, server
from conicoid_client.command.report import Failure

# In a process of its own: a broken driver can abort the process that asks.
_LISTING = """
import json
from conicoid.device import INSTALL_HINT, list_devices
print(json.dumps({"devices": [device.as_dict() for device in list_devices()], "hint": INSTALL_HINT}))
"""


def run(options: argparse.Namespace) -> None:
    """List the devices of this machine, or ask a service for its own."""
    if server(options) is not None:
        with connect(options) as client:
            found = client.device()
        files.say(json.dumps(found, indent=2) if options.json else "\n".join(_tree(found)))
        return
    devices = _devices_here()
    files.say(json.dumps(devices, indent=2) if options.json else "\n".join(map(_paragraph, devices)))


def _devices_here() -> list[dict[str, Any]]:
    listing = subprocess.run([sys.executable, "-c", _LISTING], capture_output=True, text=True, check=False)
    try:
        answer = json.loads(listing.stdout)
    except ValueError:
        last = listing.stderr.strip().splitlines()[-1:] or [f"it ended with status {listing.returncode}"]
        raise Failure(f"the OpenCL driver could not be asked for its devices: {last[0]}") from None
    devices: list[dict[str, Any]] = answer["devices"]
    if not devices:
        raise Failure(f"no OpenCL device was found; {answer['hint']}")
    return devices


def _paragraph(device: dict[str, Any]) -> str:
    """What a person needs in order to choose; CONICOID_DEVICE is matched against the first line's words."""
    gib = device["global_memory"] / 2**30
    binary64 = "binary64" if device["float64"] else "no binary64, not usable"
    return (
        f"{device['platform']} {device['version']} {device['name']}\n"
        f"  {device['compute_units']} compute units, {gib:.1f} GiB, {binary64}"
    )


def _tree(value: dict[str, Any], indent: str = "") -> list[str]:
    lines = []
    for key, item in value.items():
        if isinstance(item, dict):
            lines += [f"{indent}{key}:", *_tree(item, indent + "  ")]
        else:
            lines.append(f"{indent}{key}: {item if isinstance(item, str) else json.dumps(item)}")
    return lines
