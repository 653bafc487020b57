"""`conicoid info`: what an OpenEXR file holds."""

import argparse
import json
import math
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from conicoid_client import exr, files
from conicoid_client.command.report import Failure
from conicoid_client.exr import ExrImage, Mask, Window

_TYPES = {"float32": "FLOAT", "float16": "HALF", "uint32": "UINT"}


def run(options: argparse.Namespace) -> None:
    """Read the file and print what it holds."""
    data = files.read(options.image)
    try:
        image = exr.decode(data)
    except exr.ExrError as error:
        raise Failure(f"{options.image}: {error}") from None
    facts = {"file": options.image, "bytes": len(data), **describe(image)}
    files.say(json.dumps(facts, indent=2) if options.json else "\n".join(_text(facts)))


def describe(image: ExrImage) -> dict[str, Any]:
    """Everything worth knowing about an image, as plain values for JSON; infinities are the strings inf and -inf.

    A channel's `min`, `max` and `coverage` (a share of the data window) count the pixels that were hit and have a
    finite value there.
    """
    hits = image.hits()
    own = {name: _plain(value) for name, value in image.attributes.items() if name.startswith("conicoid/")}
    return {
        "compression": image.compression,
        "display_window": list(image.display_window),
        "data_window": list(image.data_window),
        "channels": {name: _channel(plane, hits) for name, plane in sorted(image.channels.items())},
        "conicoid": {name.removeprefix("conicoid/"): value for name, value in own.items()},
        "attributes": {name: _plain(value) for name, value in image.attributes.items() if name not in own},
    }


def _channel(plane: NDArray[Any], hits: Mask | None) -> dict[str, Any]:
    counted = np.isfinite(plane) if hits is None else np.isfinite(plane) & hits
    values = plane[counted]
    return {
        "type": _TYPES[str(plane.dtype)],
        "min": _plain(values.min()) if values.size else None,
        "max": _plain(values.max()) if values.size else None,
        "coverage": values.size / plane.size,
    }


def _plain(value: Any) -> Any:
    """A header value as JSON has it; text that is itself a JSON object (the camera) is opened."""
    if isinstance(value, np.floating):
        # In its own shortest digits: those of the nearest binary64 would show precision that is not there.
        value = float(str(value))
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, str) and value.startswith("{"):
        with suppress(ValueError):
            return json.loads(value)
    return value if isinstance(value, str | int) else str(getattr(value, "name", value))


def _text(facts: dict[str, Any]) -> Iterator[str]:
    yield f"{facts['file']}: {facts['bytes']:,} bytes, {facts['compression']}"
    yield f"display window  {_extent(facts['display_window'])}"
    yield f"data window     {_extent(facts['data_window'])}"
    yield ""
    yield from _channel_table(facts["channels"])
    for title in ("conicoid", "attributes"):
        if facts[title]:
            yield ""
            yield title
            yield from _tree(facts[title], "  ")


def _extent(window: Window) -> str:
    x0, y0, x1, y1 = window
    return f"{x1 - x0} x {y1 - y0} at ({x0}, {y0})"


def _channel_table(channels: dict[str, Any]) -> Iterator[str]:
    row = "{:<8} {:<5} {:>14} {:>14} {:>9}"
    yield row.format("channel", "type", "min", "max", "coverage")
    for name, channel in channels.items():
        low, high = (_number(channel[end]) for end in ("min", "max"))
        yield row.format(name, channel["type"], low, high, f"{channel['coverage']:.2%}")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.9g}"


def _tree(facts: dict[str, Any], indent: str) -> Iterator[str]:
    wide = max(map(len, facts), default=0)
    for name, value in facts.items():
        if isinstance(value, dict):
            yield f"{indent}{name}"
            yield from _tree(value, indent + "  ")
        elif isinstance(value, list) and value and isinstance(value[0], list):
            yield f"{indent}{name}"
            yield from (indent + "  " + " ".join(f"{_number(x):>14}" for x in row) for row in value)
        else:
            text = value if isinstance(value, str) else json.dumps(value)
            yield f"{indent}{name:<{wide}}  {text}"
