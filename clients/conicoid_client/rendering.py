"""An image as the service answers with it."""

from dataclasses import dataclass

import httpx


@dataclass(frozen=True)
class Rendering:
    """One rendered view.

    Attributes:
        exr: the OpenEXR file.
        etag: strong entity tag: the same scene rendered by the same build has the same tag.
        timing_ms: the service's own account (queue, parse, setup, cast, encode), milliseconds.
        settled: pixels that were settled in exact arithmetic on the host; None where the service did not say.
    """

    exr: bytes
    etag: str | None
    timing_ms: dict[str, float]
    settled: int | None


def read_rendering(response: httpx.Response) -> Rendering:
    """The rendering that an answer is."""
    settled = response.headers.get("Conicoid-Settled", "")
    return Rendering(
        exr=response.content,
        etag=tag_of(response),
        timing_ms=_timing(response.headers.get("Server-Timing", "")),
        settled=int(settled) if settled.isdecimal() else None,
    )


def tag_of(response: httpx.Response) -> str | None:
    """The entity tag that the service gave, though another may have sent the image."""
    answered = response.history[0] if response.history else response
    tag: str | None = answered.headers.get("ETag")
    return tag


def _timing(header: str) -> dict[str, float]:
    """`Server-Timing: cast;dur=4.1, encode;dur=97.0` as {"cast": 4.1, "encode": 97.0}."""
    times: dict[str, float] = {}
    for entry in header.split(","):
        name, *parameters = (part.strip() for part in entry.split(";"))
        for parameter in parameters:
            key, _, value = parameter.partition("=")
            if key == "dur":
                try:
                    times[name] = float(value)
                except ValueError:
                    continue
    return times
