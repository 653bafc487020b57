"""`conicoid verify`: a scene rendered as usual, then pixels of the image against exact arithmetic in this process."""

import argparse
import json
import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from conicoid_client import files
from conicoid_client.command.connect import connect
from conicoid_client.command.progress import progress
from conicoid_client.command.report import Failure
from conicoid_client.command.scene import read_scene

if TYPE_CHECKING:
    from conicoid.verify import Verdict

# Hits and ids tell a wrong pixel from a wrong depth; to ask for them does not change how the others are cast.
_MASKS = ("A", "id")
_SHOWN_DIFFERENCES = 5


@dataclass(frozen=True)
class Facts:
    """What is printed beside the verdict."""

    scene: str
    precision: str
    image_pixels: int
    settled: int | None
    render_s: float
    check_s: float


def run(options: argparse.Namespace) -> None:
    """Render, check, print; a pixel that differs is a failure."""
    files.check_writable(files.STANDARD)
    body, arrays = read_scene(options)
    name = "standard input" if options.scene == files.STANDARD else options.scene
    begin = time.perf_counter()
    with progress(f"rendering {name}"), connect(options) as client:
        document = _whole_image(client.canonical(body, arrays=arrays), options.precision)
        rendering = client.render(document)
    rendered = time.perf_counter()

    from conicoid.document import parse
    from conicoid.verify import check, every_place, sampled_places
    from conicoid_client import exr

    image = exr.decode(rendering.exr)
    scene = parse(document).resolve()
    shape = next(iter(image.channels.values())).shape
    places = every_place(shape) if options.every_pixel else sampled_places(image.channels, options.samples)
    with progress(f"checking {name}", total=len(places)) as after_each:
        verdict = check(scene, image.channels, image.data_window, places, after_each=after_each)
    pixels, seconds = shape[0] * shape[1], time.perf_counter() - rendered
    facts = Facts(name, scene.output.precision, pixels, rendering.settled, rendered - begin, seconds)
    files.say(json.dumps(_plain(facts, verdict), indent=2) if options.json else "\n".join(_table(facts, verdict)))
    if verdict.wrong:
        raise Failure("\n".join(_complaint(facts, verdict)))


def _whole_image(canonical: bytes, precision: str | None) -> bytes:
    """The scene's own channels and the masks, every pixel of the crop, nothing rounded or packed after casting."""
    document = json.loads(canonical)
    output = document["output"]
    output["channels"] += [mask for mask in _MASKS if mask not in output["channels"]]
    output |= {"data_window": "full", "half_normals": False, "compression": "none"}
    if precision is not None:
        output["precision"] = precision
    return json.dumps(document, allow_nan=False).encode()


def _plain(facts: Facts, verdict: "Verdict") -> dict[str, Any]:
    """Plain values for JSON; infinite or undefined numbers are strings."""
    plain: dict[str, Any] = json.loads(json.dumps(asdict(facts) | asdict(verdict)), parse_constant=str)
    return plain


def _table(facts: Facts, verdict: "Verdict") -> list[str]:
    from conicoid.verify import NORMAL_LIMIT, POSITION_LIMIT

    rows = [
        ("pixels checked", f"{verdict.pixels:,} of {facts.image_pixels:,}, {verdict.hits:,} of them hits"),
        ("wrong hits", f"{verdict.wrong_hits:,}"),
        ("wrong ids", f"{verdict.wrong_ids:,}"),
        *((f"misrounded {channel}", f"{count:,}") for channel, count in verdict.misrounded.items()),
    ]
    if verdict.normal_error is not None:
        rows.append(("worst normal error", f"{verdict.normal_error:.3g} (limit {NORMAL_LIMIT:.3g})"))
    if verdict.position_error is not None:
        rows.append(("worst position error", f"{verdict.position_error:.3g} ulp (limit {POSITION_LIMIT:.3g})"))
    if facts.settled is not None:
        rows.append(("settled on the host", f"{facts.settled:,} of {facts.image_pixels:,}"))
    rows.append(("time", f"{facts.render_s:.1f} s to render, {facts.check_s:.1f} s to check"))
    return [f"{facts.scene}, precision {facts.precision}", *(f"  {name:<20}  {value}" for name, value in rows)]


def _complaint(facts: Facts, verdict: "Verdict") -> list[str]:
    shown = verdict.differences[:_SHOWN_DIFFERENCES]
    return [
        f"{facts.scene}: {verdict.wrong:,} of {verdict.pixels:,} pixels are not as `precision: exact` promises:",
        *map(str, shown),
    ]
