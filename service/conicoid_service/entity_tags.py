"""Strong entity tags: equal exactly when the bytes are."""

import hashlib
from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

ENGINE = f"conicoid {version('conicoid')}, OpenEXR {version('OpenEXR')}, NumPy {version('numpy')}"


def entity_tag(scene_hash: str, device: Mapping[str, Any]) -> str:
    """The tag of a scene's image: of its canonical values and output, this build, and the device.

    The device counts for as long as its arithmetic may show in a pixel.
    """
    driver = (device["platform"], device["version"], device["name"])
    digest = hashlib.sha256(f"{scene_hash}\n{ENGINE}\n{driver}".encode()).hexdigest()
    return f'"{digest}"'


def matches(if_none_match: str | None, tag: str) -> bool:
    """Whether `If-None-Match` names `tag`: a list of tags or `*`, compared weakly (RFC 9110, 13.1.2)."""
    if if_none_match is None:
        return False
    # A tag of ours holds no comma, so a foreign tag that does cannot make a false match.
    named = [one.strip().removeprefix("W/") for one in if_none_match.split(",")]
    return named == ["*"] or tag in named
